// SPDX-License-Identifier: GPL-3.0-or-later
// Patterns, step by step.
#include "text/lanes.hpp"
#include "text/textures_text.hpp"
#include "textures/image_lanes.hpp"
#include "textures/pattern_packet.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace sfumato::SFUMATO_ISA {
namespace {

using Text = text::TexturesText<Real, Isa>;

Real loaded(const float *lanes) {
    return Real::load_aligned(lanes);
}

// What triangles have at their corners, interpolated: corner(lane, i) tells.
template <typename Corner>
Real interpolated(const PatternPacket &packet, int where, const Corner &corner) {
    alignas(64) float at[3][LANES];
    for (int i = 0; i < 3; ++i) {
        for (int lane = 0; lane < LANES; ++lane) {
            at[i][lane] = packet.place[lane] == nullptr ? 0.0F : corner(lane, i);
        }
    }
    const Real a = loaded(at[0]), b = loaded(at[1]), c = loaded(at[2]);
    return a + loaded(packet.u[where]) * (b - a) + loaded(packet.v[where]) * (c - a);
}

template <typename Number>
Real of_places(const PatternPacket &packet, const Number &number) {
    alignas(64) float of[LANES];
    for (int lane = 0; lane < LANES; ++lane) {
        of[lane] = packet.place[lane] == nullptr ? 0.0F : number(*packet.place[lane]);
    }
    return loaded(of);
}

Real own_position(const PatternPacket &packet, int axis, int where) {
    return interpolated(packet, where, [&](int lane, int i) {
        const PatternPlace &place = *packet.place[lane];
        const std::size_t vertex =
            place.triangles[std::size_t{3} * packet.triangle[lane] + static_cast<std::size_t>(i)];
        return place.vertices[3 * vertex + static_cast<std::size_t>(axis)];
    });
}

Real channel(const PatternPacket &packet, int number, int where) {
    if (packet.row[0] != nullptr) {
        alignas(64) float of[LANES];
        for (int lane = 0; lane < LANES; ++lane) {
            of[lane] = packet.row[lane][number];
        }
        return loaded(of);
    }
    return interpolated(packet, where, [&](int lane, int i) {
        const PatternPlace &place = *packet.place[lane];
        const std::size_t corner = std::size_t{3} * packet.triangle[lane] + static_cast<std::size_t>(i);
        return place.channels[corner * place.channel_count + static_cast<std::size_t>(number)];
    });
}

Real input_of(const PatternPacket &packet, int code, int where) {
    using namespace pattern_input;
    if (code >= CHANNEL) {
        return channel(packet, code - CHANNEL, where);
    }
    if (code >= PLACE) {
        return of_places(packet, [code](const PatternPlace &place) { return place.values[code - PLACE]; });
    }
    if (code == STANDS_FOR) {
        return packet.stands_for;
    }
    if (code >= TO_WORLD) {
        return of_places(packet, [code](const PatternPlace &place) { return place.to_world[code - TO_WORLD]; });
    }
    switch (code / 3) {
    case POSITION / 3:
        return loaded(packet.position[where][code - POSITION]);
    case OWN / 3:
        return own_position(packet, code - OWN, where);
    case NORMAL / 3:
        return loaded(packet.normal[code - NORMAL]);
    case FACE / 3:
        return loaded(packet.face[code - FACE]);
    case INCOMING / 3:
        return loaded(packet.incoming[code - INCOMING]);
    default:
        return loaded(packet.back);
    }
}

Real power_of(Real a, Real b) {
    const Mask whole = floor(b) == b, odd = floor(0.5F * b) != 0.5F * b;
    const Real size = pow(max(abs(a), 1e-37F), b);
    const Real signed_size = pick((a < 0.0F) & odd, -size, size);
    const Real of_nothing = pick(b == 0.0F, 1.0F, 0.0F);
    return pick(a == 0.0F, of_nothing, pick((a < 0.0F) & !whole, 0.0F, signed_size));
}

Real in_table(const std::vector<float> &table, Real at, bool stepped) {
    const auto last = static_cast<float>(table.size() - 1);
    const Real place = clamp(pick(at == at, at, 0.0F), 0.0F, 1.0F) * last;
    const Real below = min(floor(place), stepped ? last : last - 1.0F);
    const Index entry = truncate(below);
    const Real here = gather(table.data(), entry);
    return stepped ? here : here + (place - below) * (gather(table.data() + 1, entry) - here);
}

// A texture's step: what it reads, its settings, and what it writes.
struct Texture {
    const PatternRegisters &registers;
    const PatternStep &step;
    std::array<std::int16_t, STEP_INTEGERS> integer;
    PatternRegisters &out;

    [[nodiscard]] Real from(int i) const { return loaded(registers.of[step.from[static_cast<std::size_t>(i)]]); }
    [[nodiscard]] vec3 point() const { return {from(0), from(1), from(2)}; }
    void put(int i, Real value) const { value.store_aligned(out.of[step.to + i]); }
    void put(int i, const vec3 &value) const {
        put(i, value.x);
        put(i + 1, value.y);
        put(i + 2, value.z);
    }
};

void noise(const Texture &t) {
    const auto &n = t.integer;
    const bool coloured = n[4] != 0;
    const auto found = Text().noise_texture(n[0], n[1], n[2] != 0, n[3] != 0, coloured, t.point(), t.from(3), t.from(4),
                                            t.from(5), t.from(6), t.from(7), t.from(8), t.from(9));
    t.put(0, found.value);
    t.put(1, coloured ? found.colour : vec3(found.value, found.value, found.value));
}

void voronoi(const Texture &t) {
    const auto &n = t.integer;
    auto found = Text().voronoi_texture(n[0], n[1], n[2], n[3], n[4] != 0, n[5] != 0, t.point(), t.from(3), t.from(4),
                                        t.from(5), t.from(6), t.from(7), t.from(8), t.from(9));
    if (n[1] >= 3) { // which have no more
        found.position = vec3(0.0F, 0.0F, 0.0F);
        found.w = 0.0F;
    }
    t.put(0, found.value);
    t.put(1, n[5] != 0 && n[1] < 3 ? found.colour : vec3(0.0F, 0.0F, 0.0F));
    t.put(4, found.position);
    t.put(7, found.w);
}

void texture(PatternOp op, const Texture &t) {
    const auto &n = t.integer;
    const vec3 black(0.0F, 0.0F, 0.0F), white(1.0F, 1.0F, 1.0F);
    switch (op) {
    case PatternOp::NOISE:
        return noise(t);
    case PatternOp::MUSGRAVE:
        return t.put(0, Text().musgrave_texture(n[0], n[1], n[2] != 0, t.point(), t.from(3), t.from(4), t.from(5),
                                                t.from(6), t.from(7), t.from(8)));
    case PatternOp::VORONOI:
        return voronoi(t);
    case PatternOp::CHECKER:
        return t.put(0, Text().checker_texture(t.point(), white, black).value);
    case PatternOp::BRICKS: {
        const auto found = Text().brick_texture({t.from(0), t.from(1), 0.0F}, black, white, black, t.from(2), t.from(3),
                                                t.from(4), t.from(5), t.from(6), t.from(7), n[0], t.from(8), n[1]);
        t.put(0, found.value);
        return t.put(1, found.colour.x);
    }
    case PatternOp::MAGIC: {
        const auto found = Text().magic_texture(t.point(), n[0], t.from(3));
        t.put(0, found.value);
        return t.put(1, found.colour);
    }
    case PatternOp::WAVE:
        return t.put(0, Text().wave_texture(n[0], n[1], n[2], n[3] != 0, t.point(), t.from(3), t.from(4), t.from(5),
                                            t.from(6), t.from(7)));
    default: {
        const bool coloured = n[1] != 0;
        const auto found = Text().white_noise_texture(n[0], coloured, t.point(), t.from(3));
        t.put(0, found.value);
        return t.put(1, coloured ? found.colour : black);
    }
    }
}

Real calculated(const Pattern &pattern, const PatternStep &step, const Real &a, const Real &b, const Real &c) {
    switch (step.op) {
    case PatternOp::ADD:
        return a + b;
    case PatternOp::SUBTRACT:
        return a - b;
    case PatternOp::MULTIPLY:
        return a * b;
    case PatternOp::DIVIDE: {
        const Mask none = b == 0.0F;
        return pick(none, 0.0F, a / pick(none, 1.0F, b));
    }
    case PatternOp::MINIMUM:
        return min(a, b);
    case PatternOp::MAXIMUM:
        return max(a, b);
    case PatternOp::POWER:
        return power_of(a, b);
    case PatternOp::FLOOR:
        return floor(a);
    case PatternOp::CEIL:
        return ceil(a);
    case PatternOp::TRUNCATE:
        return xsimd::trunc(a);
    case PatternOp::SQUARE_ROOT:
        return sqrt(max(a, 0.0F));
    case PatternOp::ABSOLUTE:
        return abs(a);
    case PatternOp::SIGN:
        return pick(a > 0.0F, 1.0F, pick(a < 0.0F, -1.0F, 0.0F));
    case PatternOp::EXPONENT:
        return exp(min(a, 88.0F));
    case PatternOp::LOGARITHM:
        return pick(a > 0.0F, log(max(a, 1e-37F)), 0.0F);
    case PatternOp::SINE:
        return sin(a);
    case PatternOp::COSINE:
        return cos(a);
    case PatternOp::ARC_TANGENT:
        return atan(a, b);
    case PatternOp::LESS:
        return pick(a < b, 1.0F, 0.0F);
    case PatternOp::EQUAL:
        return pick(a == b, 1.0F, 0.0F);
    case PatternOp::SELECT:
        return pick(a != 0.0F, b, c);
    case PatternOp::TABLE:
    case PatternOp::STEPPED_TABLE:
        return in_table(pattern.tables[step.setting], a, step.op == PatternOp::STEPPED_TABLE);
    default:
        return 0.0F;
    }
}

void image(const Texture &t, const Pattern::LookUp &look) {
    // Of lanes that hit nothing, anything.
    const auto step = [&t](int i) {
        constexpr float WHOLE = 1e4F; // pictures: their mean is seen
        const Real x = t.from(i);
        return pick(x == x, clamp(x, -WHOLE, WHOLE), 0.0F);
    };
    const ImageFootprint footprint{{step(2), step(3)}, {step(4), step(5)}};
    const Rgba found =
        look_up(look.image->view(), look.interpolation, look.extension, t.from(0), t.from(1), footprint, Mask(true));
    t.put(0, {found.r, found.g, found.b});
    t.put(3, found.a);
}

} // namespace

void run_pattern(const Pattern &pattern, std::span<const PatternStep> steps, const PatternPacket &packet,
                 PatternRegisters &registers) {
    for (const PatternStep &step : steps) {
        if (is_texture(step.op)) {
            texture(step.op, {registers, step, pattern.integers[step.setting], registers});
            continue;
        }
        if (step.op == PatternOp::IMAGE) {
            image({registers, step, {}, registers}, pattern.look_ups[step.setting]);
            continue;
        }
        const auto from = [&](std::size_t i) { return loaded(registers.of[step.from[i]]); };
        Real to = 0.0F;
        if (step.op == PatternOp::CONSTANT) {
            to = pattern.constants[step.setting];
        } else if (step.op == PatternOp::INPUT) {
            to = input_of(packet, step.setting, step.from[0]);
        } else {
            const int inputs = pattern_inputs(step.op);
            const Real a = from(0), b = inputs > 1 ? from(1) : a, c = inputs > 2 ? from(2) : a;
            to = calculated(pattern, step, a, b, c);
        }
        to.store_aligned(registers.of[step.to]);
    }
}

} // namespace sfumato::SFUMATO_ISA
