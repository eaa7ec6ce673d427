// SPDX-License-Identifier: GPL-3.0-or-later
#include "solids/surfaces.hpp"

#include "scene/scene.hpp"
#include "text/surfaces_text.hpp"
#include "textures/pattern.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

#include <glm/common.hpp>
#include <glm/matrix.hpp>

namespace sfumato {
namespace {

EmbreeDevice new_device(int threads) {
    const std::string settings = threads > 0 ? "threads=" + std::to_string(threads) : std::string();
    EmbreeDevice device(rtcNewDevice(settings.c_str()));
    if (!device) {
        throw std::runtime_error("Embree could not start");
    }
    return device;
}

// Rays pass through what Embree could not make, without a word.
void require_made(RTCDevice device, const char *what) {
    const RTCError error = rtcGetDeviceError(device);
    if (error == RTC_ERROR_OUT_OF_MEMORY) {
        throw std::runtime_error(std::string("no memory for ") + what + " of the scene");
    }
    if (error != RTC_ERROR_NONE) {
        throw std::runtime_error(std::string("Embree cannot use ") + what + " of the scene: error " +
                                 std::to_string(static_cast<int>(error)));
    }
}

// The three columns of a matrix one after the other.
void copy_columns(const glm::dmat3 &m, float (&to)[9]) {
    for (int column = 0; column < 3; ++column) {
        for (int row = 0; row < 3; ++row) {
            to[3 * column + row] = static_cast<float>(m[column][row]);
        }
    }
}

// What takes normals to the world, not their lengths: the cofactors, which are the inverse transpose times the
// determinant, and which an object without thickness has too.
glm::dmat3 cofactors(const glm::dmat3 &m) {
    const glm::dmat3 out(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
    const double determinant = glm::dot(m[0], out[0]);
    const double largest = std::max({glm::length(out[0]), glm::length(out[1]), glm::length(out[2]), 1e-300});
    return out * ((determinant < 0.0 ? -1.0 : 1.0) / largest);
}

void put(std::span<float> row, int at, const glm::vec3 &colour) {
    std::copy_n(&colour.x, 3, row.begin() + at);
}

void put_lobe(std::span<float> row, const Gloss &gloss, const GlossCurves &curves) {
    using namespace lobe_row;
    put(row, REFLECTANCE, gloss.reflectance);
    put(row, DIP, gloss.dip);
    row[EDGE] = gloss.edge;
    row[ALPHA_X] = gloss.alpha[0];
    row[ALPHA_Y] = gloss.alpha[1];
    row[APART] = gloss.apart ? 1.0F : 0.0F;
    row[INDEX] = gloss.index;
    row[BECKMANN] = gloss.beckmann ? 1.0F : 0.0F;
    row[SHARE] = gloss.share;
    row[TURN] = gloss.turn;
    row[TURN_COSINE] = std::cos(2.0F * std::numbers::pi_v<float> * gloss.turn);
    row[TURN_SINE] = std::sin(2.0F * std::numbers::pi_v<float> * gloss.turn);
    std::ranges::copy(curves.left, row.begin() + LEFT);
    for (int c = 0; c < 3; ++c) {
        std::ranges::copy(curves.gain[c], row.begin() + GAIN + c * CURVE_POINTS);
    }
}

// What grooves send on after the first reflection, as grooves_again() has it.
glm::vec3 again_of(const Diffuse &diffuse, const glm::vec3 &albedo) {
    if (diffuse.spreading != Spreading::GROOVES_AGAIN && diffuse.spreading != Spreading::GROOVES_DEEPER) {
        return glm::vec3(0.0F);
    }
    glm::vec3 again;
    for (int c = 0; c < 3; ++c) {
        again[c] = text::SurfacesText<float>().grooves_again(albedo[c], diffuse.roughness);
    }
    return diffuse.spreading == Spreading::GROOVES_DEEPER ? again * albedo : again;
}

void append_rows(const Materials &materials, bool lamp, Solids &solids, std::vector<float> &properties) {
    using namespace material_row;
    const std::size_t count = materials.albedo.size(), lobes = count == 0 ? 0 : materials.gloss.size() / count;
    for (std::size_t i = 0; i < count; ++i) {
        properties.resize(properties.size() + FLOATS);
        const std::span<float> row = std::span(properties).last(FLOATS);
        const Diffuse diffuse = i < materials.diffuse.size() ? materials.diffuse[i] : Diffuse{};
        put(row, ALBEDO, materials.albedo[i]);
        put(row, EMISSION, i < materials.emission.size() ? materials.emission[i] : glm::vec3(0.0F));
        put(row, AGAIN, again_of(diffuse, materials.albedo[i]));
        put(row, TRANSMITTANCE, i < materials.transmittance.size() ? materials.transmittance[i] : glm::vec3(0.0F));
        put(row, TRANSLUCENCE, i < materials.translucence.size() ? materials.translucence[i] : glm::vec3(0.0F));
        const Sheen sheen = i < materials.sheen.size() ? materials.sheen[i] : Sheen{};
        put(row, SHEEN, sheen.colour);
        row[SHEEN_SPREADING] = static_cast<float>(sheen.spread.spreading);
        row[SHEEN_ROUGHNESS] = sheen.spread.roughness;
        row[SPREADING] = static_cast<float>(diffuse.spreading);
        row[ROUGHNESS] = diffuse.roughness;
        row[NUMBER] = i < materials.index.size() ? static_cast<float>(materials.index[i]) : 0.0F;
        row[LAMP] = lamp ? 1.0F : 0.0F;
        for (std::size_t k = 0; k < lobes; ++k) {
            const Gloss &gloss = materials.gloss[i * lobes + k];
            put_lobe(row.subspan(FIRST_LOBE + k * lobe_row::FLOATS), gloss, *solids.curves(gloss));
            row[LOBES] = gloss.alpha[0] > 0.0F ? static_cast<float>(k + 1) : row[LOBES];
        }
    }
}

// The vertices of a shape at a time, moved to their place.
void copy_vertices(std::span<const glm::vec3> from, const glm::dmat4 &to_world, unsigned time, RTCGeometry geometry) {
    auto *vertices = static_cast<glm::vec3 *>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, time, RTC_FORMAT_FLOAT3, sizeof(glm::vec3), from.size()));
    if (vertices == nullptr) {
        return; // the device knows
    }
    for (const glm::vec3 &vertex : from) {
        *vertices++ = glm::vec3(to_world * glm::dvec4(glm::dvec3(vertex), 1.0));
    }
}

// The triangles of a shape, moved to the place of a number, and with it.
void copy_to_world(const Instances &mesh, std::size_t number, RTCGeometry geometry) {
    const Shape &shape = *mesh.shape;
    const std::size_t times = std::max({mesh.moving.size(), shape.moving.size(), std::size_t{1}});
    rtcSetGeometryTimeStepCount(geometry, static_cast<unsigned>(times));
    for (std::size_t time = 0; time < times; ++time) {
        // Where the two have different times, the shape's nearest.
        const auto nearest = [time, times](std::size_t count) {
            return times == 1 ? 0 : time * (count - 1) / (times - 1);
        };
        copy_vertices(
            shape.moving.empty() ? shape.vertices : shape.moving[nearest(shape.moving.size())],
            glm::dmat4(mesh.moving.empty() ? mesh.to_world[number] : mesh.moving[nearest(mesh.moving.size())][number]),
            static_cast<unsigned>(time), geometry);
    }
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, shape.triangles.data(), 0,
                               sizeof(glm::uvec3), shape.triangles.size());
}

bool is_moving(const Instances &mesh) {
    return !mesh.moving.empty() || !mesh.shape->moving.empty();
}

bool is_instanced(const Instances &mesh) {
    constexpr std::size_t FEW = 20000; // triangles: a few milliseconds to copy
    return mesh.to_world.size() > 1 || mesh.shape->triangles.size() > FEW || is_moving(mesh);
}

// Whether rays can be taken into the space of a shape there, whatever the time: Embree does not ask, and rays of no
// numbers end the process.
bool can_be_entered(const Instances &mesh, std::size_t number) {
    double first = 0.0;
    const auto enters = [&first](const glm::mat4 &to_world) {
        const glm::dmat3 linear = glm::dmat3(glm::dmat4(to_world));
        const double longest = std::max({glm::length(linear[0]), glm::length(linear[1]), glm::length(linear[2])});
        const double determinant = glm::determinant(linear);
        first = first == 0.0 ? determinant : first;
        // Between two that are turned inside out there is one that is flat.
        return std::abs(determinant) > 1e-9 * longest * longest * longest && determinant * first > 0.0;
    };
    return enters(mesh.to_world[number]) &&
           std::ranges::all_of(mesh.moving, [&](const std::vector<glm::mat4> &time) { return enters(time[number]); });
}

void set_matrix(const glm::mat4 &to_world, PlaceView &view) {
    const glm::dmat3 linear = glm::dmat3(glm::dmat4(to_world));
    copy_columns(linear, view.to_world);
    copy_columns(cofactors(linear), view.normals_to_world);
}

bool stands(const Instances &mesh) {
    return mesh.shape && !mesh.shape->triangles.empty() && !mesh.to_world.empty();
}

} // namespace

PlaceView view_of(const Shape &shape, const glm::mat4 &to_world, std::int32_t first_material) {
    PlaceView view;
    const auto first = [](const auto &values) { return values.empty() ? nullptr : &values.front()[0].x; };
    view.vertices = shape.vertices.empty() ? nullptr : &shape.vertices.front().x;
    view.triangles = shape.triangles.empty() ? nullptr : &shape.triangles.front().x;
    view.corner_normals = first(shape.corner_normals);
    view.vertex_normals = shape.vertex_normals.empty() ? nullptr : &shape.vertex_normals.front().x;
    view.corner_tangents = first(shape.corner_tangents);
    view.material = shape.material.empty() ? nullptr : shape.material.data();
    view.channels = shape.channels.empty() ? nullptr : shape.channels.data();
    view.channel_count = shape.channel_count;
    view.first_material = first_material;
    set_matrix(to_world, view);
    return view;
}

Solid::Solid(RTCDevice device, std::shared_ptr<const Shape> shape, bool sheet) : shape_(std::move(shape)) {
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    const auto set_vertices = [&](const std::vector<glm::vec3> &own, std::size_t time) {
        const std::vector<glm::vec3> *vertices = &own;
        if (own.capacity() == own.size()) {
            // Embree loads sixteen bytes for the last vertex, too.
            std::vector<glm::vec3> &padded = padded_.emplace_back();
            padded.reserve(own.size() + 1);
            padded.assign(own.begin(), own.end());
            vertices = &padded;
        }
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, static_cast<unsigned>(time), RTC_FORMAT_FLOAT3,
                                   vertices->data(), 0, sizeof(glm::vec3), own.size());
    };
    if (shape_->moving.empty()) {
        set_vertices(shape_->vertices, 0);
    } else {
        rtcSetGeometryTimeStepCount(geometry, static_cast<unsigned>(shape_->moving.size()));
        for (std::size_t time = 0; time < shape_->moving.size(); ++time) {
            set_vertices(shape_->moving[time], time);
        }
    }
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, shape_->triangles.data(), 0,
                               sizeof(glm::uvec3), shape_->triangles.size());
    // A tree along a curve instead of one by surface areas saves .3 us a triangle and costs .3 us a pixel, a sixth of
    // what surfaces take: worth it for meshes that have more triangles than most pictures have pixels.
    constexpr std::size_t MANY = 1 << 21;
    const RTCBuildQuality quality = shape_->triangles.size() > MANY ? RTC_BUILD_QUALITY_LOW : RTC_BUILD_QUALITY_MEDIUM;
    rtcSetGeometryBuildQuality(geometry, quality);
    rtcCommitGeometry(geometry);
    scene_.reset(rtcNewScene(device));
    rtcSetSceneFlags(scene_.get(), sheet ? FILTERED : RTC_SCENE_FLAG_NONE);
    rtcSetSceneBuildQuality(scene_.get(), quality);
    rtcAttachGeometry(scene_.get(), geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_.get());
    require_made(device, "the triangles");
}

Solids::Solids(int threads) : threads_(threads) {}

std::shared_ptr<const Solid> Solids::solid(const std::shared_ptr<const Shape> &shape, bool sheet) {
    return solids_.get(Key().part(shape).number(sheet), [&] { return Solid(device_.get(), shape, sheet); });
}

std::shared_ptr<const Places> Solids::places(const Divided &all, const std::vector<bool> &which) {
    // Each that stands, with the number of its first place.
    struct Standing {
        const Instances *mesh;
        bool sheet;
        unsigned first;
    };
    std::vector<Standing> standing;
    unsigned number = 0;
    for (std::size_t i = 0; i < all.meshes().size(); ++i) {
        const Instances &mesh = all.meshes()[i];
        if (stands(mesh)) {
            if (which[i]) {
                standing.push_back({&mesh, all.sheet(i), number});
            }
            number += static_cast<unsigned>(mesh.to_world.size());
        }
    }
    if (standing.empty()) {
        return nullptr;
    }
    if (!device_) {
        device_ = new_device(threads_);
    }
    Key key;
    bool sheets = false;
    for (const auto &[mesh, sheet, first] : standing) {
        key.part(mesh->shape).number(first).number(sheet);
        key.numbers(std::span(&mesh->to_world.front()[0].x, 16 * mesh->to_world.size()));
        for (const std::vector<glm::mat4> &time : mesh->moving) {
            key.numbers(std::span(&time.front()[0].x, 16 * time.size()));
        }
        sheets = sheets || sheet;
        if (is_instanced(*mesh)) {
            solid(mesh->shape, sheet); // asked for in this round too, though the places may be known
        }
    }
    return places_.get(key, [&] {
        Places places;
        places.scene.reset(rtcNewScene(device_.get()));
        rtcSetSceneFlags(places.scene.get(), sheets ? FILTERED : RTC_SCENE_FLAG_NONE);
        for (const auto &[mesh, sheet, first] : standing) {
            attach(*mesh, sheet, places, first);
        }
        rtcCommitScene(places.scene.get());
        require_made(device_.get(), "the triangles");
        return places;
    });
}

void Solids::attach(const Instances &mesh, bool sheet, Places &places, unsigned number) {
    const bool instanced = is_instanced(mesh);
    places.instanced = places.instanced || instanced;
    const std::shared_ptr<const Solid> what = instanced ? solid(mesh.shape, sheet) : nullptr;
    places.kept.push_back(mesh.shape);
    if (what) {
        places.kept.push_back(what);
    }
    for (std::size_t i = 0; i < mesh.to_world.size(); ++i) {
        const bool entered = instanced && can_be_entered(mesh, i);
        const RTCGeometry place =
            rtcNewGeometry(device_.get(), entered ? RTC_GEOMETRY_TYPE_INSTANCE : RTC_GEOMETRY_TYPE_TRIANGLE);
        if (entered) {
            rtcSetGeometryInstancedScene(place, what->scene());
            const std::size_t times = std::max(mesh.moving.size(), std::size_t{1});
            rtcSetGeometryTimeStepCount(place, static_cast<unsigned>(times));
            for (std::size_t time = 0; time < times; ++time) {
                const glm::mat4 &to_world = mesh.moving.empty() ? mesh.to_world[i] : mesh.moving[time][i];
                rtcSetGeometryTransform(place, static_cast<unsigned>(time), RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR,
                                        &to_world[0].x);
            }
        } else {
            copy_to_world(mesh, i, place);
        }
        rtcCommitGeometry(place);
        rtcAttachGeometryByID(places.scene.get(), place, number++);
        rtcReleaseGeometry(place);
    }
}

std::shared_ptr<const GlossCurves> Solids::curves(const Gloss &gloss) {
    Key key;
    key.numbers(std::span(&gloss.reflectance.x, 3)).numbers(std::span<const float>(gloss.alpha));
    key.numbers(std::span(&gloss.dip.x, 3));
    key.number(gloss.edge, gloss.index, gloss.share, gloss.below, gloss.lossless);
    return curves_.get(key, [&] { return gloss_curves(gloss); });
}

std::shared_ptr<const GlossTable> Solids::table(const Gloss &gloss) {
    Key key;
    key.number(gloss.edge, gloss.index, gloss.below, gloss.lossless);
    return tables_.get(key, [&] { return gloss_table(gloss); });
}

void Solids::end_round() {
    curves_.end_round();
    tables_.end_round();
    places_.end_round();
    solids_.end_round();
    parts_.end_round();
}

Surfaces::Surfaces(std::span<const Instances> scene, std::span<const Light> lights, Solids &solids) {
    const Divided divided(scene, solids.parts());
    const std::span<const Instances> meshes = divided.meshes();
    // is_met(visibility, sheet)
    const auto places = [&](auto &&is_met) {
        std::vector<bool> which;
        for (std::size_t i = 0; i < meshes.size(); ++i) {
            which.push_back(is_met(meshes[i].visibility, divided.sheet(i)));
        }
        const bool all = std::find(which.begin(), which.end(), false) == which.end();
        return all && all_ ? all_ : solids.places(divided, which);
    };
    plain_ = std::all_of(meshes.begin(), meshes.end(),
                         [](const Instances &mesh) { return mesh.visibility == Visibility{}; });
    opaque_ = std::all_of(meshes.begin(), meshes.end(), [](const Instances &mesh) {
        return mesh.visibility.seen == Seen::SHOWN || mesh.visibility.seen == Seen::UNSEEN;
    });
    all_ = places([](const Visibility &, bool) { return true; });
    // What is not itself that is seen does not let through to the eye.
    seen_ = places(
        [](const Visibility &v, bool sheet) { return v.seen != Seen::UNSEEN && !(sheet && v.seen == Seen::SHOWN); });
    sheets_ = places([](const Visibility &v, bool sheet) { return v.seen == Seen::SHOWN && sheet; });
    for (const Light &light : lights) {
        const LightSets sets = light.reach.hidden_by;
        if (sets != 0 && hiding_.count(sets) == 0) {
            hiding_[sets] = places([&](const Visibility &v, bool sheet) { return (v.hides & sets) != 0 && !sheet; });
            dimming_[sets] = places([&](const Visibility &v, bool sheet) { return (v.hides & sets) != 0 && sheet; });
        }
    }
    if (!plain_) {
        catchers_ = places([](const Visibility &v, bool) { return v.seen == Seen::CATCHER; });
    }
    for (std::size_t number = 0; number < meshes.size(); ++number) {
        const Instances &mesh = meshes[number];
        if (!stands(mesh)) {
            continue;
        }
        const bool sheet = divided.sheet(number) && mesh.visibility.seen == Seen::SHOWN;
        const auto first_material = static_cast<std::int32_t>(properties_.size() / material_row::FLOATS);
        append_rows(mesh.materials, mesh.lamp, solids, properties_);
        add_varying(mesh.materials, static_cast<std::size_t>(first_material), solids);
        for (const glm::vec3 &left : mesh.materials.transmittance) {
            transmittances_.insert(transmittances_.end(), {left.x, left.y, left.z});
        }
        more_ = more_ || !mesh.materials.translucence.empty() || !mesh.materials.sheen.empty();
        tangents_ = tangents_ || !mesh.shape->corner_tangents.empty();
        values_.push_back(mesh.values);
        moves_ = moves_ || is_moving(mesh);
        for (std::size_t i = 0; i < mesh.to_world.size(); ++i) {
            for (const std::vector<glm::mat4> &time : mesh.moving) {
                moving_[views_.size()].push_back(time[i]);
            }
            if (sheet) {
                sheet_places_.push_back({mesh.shape, mesh.to_world[i], static_cast<std::uint32_t>(views_.size()),
                                         static_cast<std::uint32_t>(first_material)});
            }
            views_.push_back(view_of(*mesh.shape, mesh.to_world[i], first_material));
            if (const std::size_t each = mesh.values.size() / mesh.to_world.size(); each > 0) {
                views_.back().values = values_.back().data() + i * each;
            }
            views_.back().object_index = i < mesh.index.size() ? static_cast<float>(mesh.index[i]) : 0.0F;
            views_.back().visibility = mesh.visibility;
        }
    }
}

void Surfaces::add_varying(const Materials &materials, std::size_t first_row, Solids &solids) {
    const std::size_t lobes = materials.albedo.empty() ? 0 : materials.gloss.size() / materials.albedo.size();
    for (std::size_t row = 0; row < materials.patterns.size(); ++row) {
        const std::shared_ptr<const Pattern> &pattern = materials.patterns[row];
        if (!pattern) {
            continue;
        }
        Varying varying;
        varying.pattern = pattern.get();
        patterns_.push_back(pattern);
        if (pattern->dims) {
            dimming_patterns_.push_back(pattern);
        }
        for (std::size_t k = 0; k < lobes; ++k) {
            using namespace pattern_slot;
            constexpr std::uint64_t ALL = (std::uint64_t{1} << LOBE_SLOTS) - 1;
            if ((pattern->given >> (FIRST_LOBE + k * LOBE_SLOTS) & ALL) != 0) {
                const std::shared_ptr<const GlossTable> table = solids.table(materials.gloss[row * lobes + k]);
                varying.gloss[k] = table.get();
                patterns_.push_back(table);
            }
        }
        varying_.push_back(varying);
        properties_[(first_row + row) * material_row::FLOATS + material_row::PATTERN] =
            static_cast<float>(varying_.size());
    }
}

void Surfaces::add_dimming(Key &key) const {
    key.numbers(std::span<const float>(transmittances_));
    for (const std::shared_ptr<const Pattern> &each : dimming_patterns_) {
        key.part(each);
    }
}

bool Surfaces::dims_greyly() const {
    for (std::size_t i = 0; i < transmittances_.size(); i += 3) {
        if (transmittances_[i] != transmittances_[i + 1] || transmittances_[i] != transmittances_[i + 2]) {
            return false;
        }
    }
    return std::all_of(dimming_patterns_.begin(), dimming_patterns_.end(),
                       [](const std::shared_ptr<const Pattern> &pattern) { return pattern->dims_greyly; });
}

RayScene view_of(const std::shared_ptr<const Places> &places) {
    return places ? RayScene{places->scene.get(), places->instanced} : RayScene{};
}

SurfaceView Surfaces::view() const {
    return {view_of(all_),
            view_of(seen_),
            view_of(sheets_),
            view_of(catchers_),
            plain_,
            views_.data(),
            properties_.data(),
            tangents_,
            varying_.empty() ? nullptr : varying_.data(),
            more_};
}

std::vector<PlaceView> Surfaces::places_at(float time) const {
    std::vector<PlaceView> out = views_;
    for (const auto &[number, matrices] : moving_) {
        const float place = time * static_cast<float>(matrices.size() - 1);
        const std::size_t from = std::min(static_cast<std::size_t>(place), matrices.size() - 2);
        const float beyond = place - static_cast<float>(from);
        set_matrix(matrices[from] * (1.0F - beyond) + matrices[from + 1] * beyond, out[number]);
    }
    return out;
}

std::optional<Box> Surfaces::bounds() const {
    if (all_ == nullptr) {
        return std::nullopt;
    }
    RTCBounds of;
    rtcGetSceneBounds(all_->scene.get(), &of);
    return Box{{of.lower_x, of.lower_y, of.lower_z}, {of.upper_x, of.upper_y, of.upper_z}};
}

std::shared_ptr<const Places> Surfaces::hiding(const Light &light) const {
    const auto found = hiding_.find(light.reach.hidden_by);
    return found == hiding_.end() ? nullptr : found->second;
}

std::shared_ptr<const Places> Surfaces::dimming(const Light &light) const {
    const auto found = dimming_.find(light.reach.hidden_by);
    return found == dimming_.end() ? nullptr : found->second;
}

} // namespace sfumato
