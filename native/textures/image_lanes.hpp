// SPDX-License-Identifier: GPL-3.0-or-later
// Looking up pictures on surfaces.
//
// What a pixel shows of a picture is the mean over its footprint: a parallelogram. Of it, two lengths along its
// ellipse's axes are kept. Where even the longer is below a texel, the picture is shown as it is between its texels.
// Else the shorter says how coarse means may be, and of these up to PROBES are taken along the longer (Feline:
// McCormack et al., "Feline: fast elliptical lines for anisotropic texture mapping", 1999). Lengths are the footprint's
// variances: that of a level's texels, with what mixes between them, and that of the probes' places add up to it, so
// nothing is blurred by more than it must be.
#pragma once

#include "text/lanes.hpp"
#include "textures/image.hpp"

#include <array>
#include <cstddef>

namespace sfumato::SFUMATO_ISA {
namespace {

struct Rgba {
    Real r, g, b, a;
};

// How far the place on the picture moves along each axis of a pixel: so far reaches the pixel in the picture.
struct ImageFootprint {
    struct Step {
        Real u, v;
    } across, up;
};

// Detail for these look-ups alone.
namespace images {

constexpr float PROBES = 16.0F;

inline Rgba scaled(const Rgba &c, Real by) {
    return {c.r * by, c.g * by, c.b * by, c.a * by};
}
inline void add(Rgba &sum, const Rgba &c, Real by) {
    sum = {xsimd::fma(c.r, by, sum.r), xsimd::fma(c.g, by, sum.g), xsimd::fma(c.b, by, sum.b),
           xsimd::fma(c.a, by, sum.a)};
}

// sRGB's curve, IEC 61966-2-1, within [0, 1]: our fit by least squares with Lawson's weights, 2e-5.
inline Real linear_within(Real x) {
    Real sum = -0.0782538727F;
    for (const float next : {0.29654932F, -0.512501955F, 0.757719874F, 0.5013991F, 0.0341846347F, 0.00088102516F}) {
        sum = xsimd::fma(sum, x, Real(next));
    }
    return pick(x <= 0.04045F, x * (1.0F / 12.92F), sum);
}

inline Real linear_of(Real x) {
    const Mask beyond = x > 1.0F;
    const Real within = linear_within(clamp(x, 0.0F, 1.0F));
    if (!any_lane(beyond)) {
        return within;
    }
    return pick(beyond, pow((max(x, 1.0F) + 0.055F) * (1.0F / 1.055F), 2.4F), within);
}

// A level of the pyramid, which is another one in each lane.
struct Level {
    Index start, columns;
    Real width, height;
};

inline Level level_of(const ImageView &image, Real number) {
    const Index at = truncate(number);
    const Index columns = gather(image.starts + SurfaceImage::LEVELS, at);
    return {gather(image.starts, at), columns, xsimd::to_float(columns),
            xsimd::to_float(gather(image.starts + 2 * SurfaceImage::LEVELS, at))};
}

inline Level finest(const ImageView &image) {
    return {Index(0), Index(image.width), Real(static_cast<float>(image.width)),
            Real(static_cast<float>(image.height))};
}

// A channel of four bytes, as a number up to 255.
template <int CHANNEL>
Real byte_in(Index four) {
    Index shifted = four;
    if constexpr (CHANNEL > 0) {
        shifted = four >> (8 * CHANNEL);
    }
    return xsimd::to_float(shifted & Index(255));
}

// As it is written, within [0, 1] if bytes.
inline Rgba texel(const ImageView &image, Index at) {
    if (image.bytes != nullptr) {
        const Index four = gather(image.bytes, at);
        constexpr float UNIT = 1.0F / 255.0F;
        return {byte_in<0>(four) * UNIT, byte_in<1>(four) * UNIT, byte_in<2>(four) * UNIT, byte_in<3>(four) * UNIT};
    }
    const Index first = at * Index(4);
    return {gather(image.floats, first), gather(image.floats + 1, first), gather(image.floats + 2, first),
            gather(image.floats + 3, first)};
}

// Of the levels after the first: linear, and multiplied by alpha where that counts.
inline Rgba coarse_texel(const ImageView &image, Index at) {
    Rgba c = texel(image, at);
    if (image.bytes == nullptr) {
        return c;
    }
    if (image.meaning.curved) {
        c = {linear_within(c.r), linear_within(c.g), linear_within(c.b), c.a};
    }
    return image.meaning.divided ? Rgba{c.r * c.a, c.g * c.a, c.b * c.a, c.a} : c;
}

// A place within what repeats, or near enough to the picture that it fits an integer.
inline Real near(Extension extension, Real u) {
    switch (extension) {
    case Extension::REPEAT:
        return u - floor(u);
    case Extension::MIRROR:
        return u - 2.0F * floor(0.5F * u);
    default:
        return clamp(u, -2.0F, 3.0F);
    }
}

// A whole number of a texel and its share, along one axis.
struct Tap {
    Real number, share;
};

// Beyond the edges by no more than twice the size; of a lone texel by two.
inline Tap wrapped(Extension extension, Real number, Real size, Real share) {
    switch (extension) {
    case Extension::REPEAT:
        for (int turn = 0; turn < 2; ++turn) {
            number = number + pick(number < 0.0F, size, 0.0F);
            number = number - pick(number >= size, size, 0.0F);
        }
        break;
    case Extension::MIRROR: {
        number = pick(number < 0.0F, -1.0F - number, number);
        number = number - pick(number >= 2.0F * size, 2.0F * size, 0.0F);
        number = pick(number >= size, 2.0F * size - 1.0F - number, number);
        break;
    }
    case Extension::CLIP:
        share = pick((number < 0.0F) | (number >= size), 0.0F, share);
        break;
    default:
        break;
    }
    return {clamp(number, 0.0F, size - 1.0F), share};
}

template <std::size_t TAPS>
using Taps = std::array<Tap, TAPS>;

inline Taps<1> closest(Extension extension, Real u, Real size) {
    // The far edge is the last texel's.
    const Mask beyond = (u < 0.0F) | (u > 1.0F);
    const Real share = extension == Extension::CLIP ? pick(beyond, 0.0F, 1.0F) : Real(1.0F);
    const Extension within = extension == Extension::CLIP ? Extension::EXTEND : extension;
    return {wrapped(within, floor(u * size), size, share)};
}

inline Taps<2> linear(Extension extension, Real u, Real size) {
    const Real x = u * size - 0.5F, first = floor(x), share = x - first;
    return {wrapped(extension, first, size, 1.0F - share), wrapped(extension, first + 1.0F, size, share)};
}

// B-splines.
inline Taps<4> cubic(Extension extension, Real u, Real size) {
    const Real x = u * size - 0.5F, first = floor(x), t = x - first, s = 1.0F - t;
    constexpr float SIXTH = 1.0F / 6.0F;
    return {wrapped(extension, first - 1.0F, size, SIXTH * s * s * s),
            wrapped(extension, first, size, SIXTH * (4.0F + 3.0F * t * t * (t - 2.0F))),
            wrapped(extension, first + 1.0F, size, SIXTH * (4.0F + 3.0F * s * s * (s - 2.0F))),
            wrapped(extension, first + 2.0F, size, SIXTH * t * t * t)};
}

template <std::size_t TAPS, typename Fetch>
Rgba mixed(const Level &level, const Taps<TAPS> &columns, const Taps<TAPS> &rows, const Fetch &fetch) {
    Rgba sum{0.0F, 0.0F, 0.0F, 0.0F};
    std::array<Index, TAPS> column;
    for (std::size_t i = 0; i < TAPS; ++i) {
        column[i] = truncate(columns[i].number);
    }
    for (const Tap &row : rows) {
        const Index start = level.start + truncate(row.number) * level.columns;
        for (std::size_t i = 0; i < TAPS; ++i) {
            add(sum, fetch(start + column[i]), row.share * columns[i].share);
        }
    }
    return sum;
}

// As a picture is between its texels, decoded; the alpha in it has not multiplied it.
inline Rgba shown(const ImageView &image, Interpolation interpolation, Extension extension, Real u, Real v) {
    const Level level = finest(image);
    const auto fetch = [&image](Index at) { return texel(image, at); };
    const auto by = [&](const auto &taps) {
        return mixed(level, taps(extension, u, level.width), taps(extension, v, level.height), fetch);
    };
    Rgba c = interpolation == Interpolation::LINEAR    ? by([](auto... a) { return linear(a...); })
             : interpolation == Interpolation::CLOSEST ? by([](auto... a) { return closest(a...); })
                                                       : by([](auto... a) { return cubic(a...); });
    if (image.meaning.divided) {
        const Real by_alpha = pick((c.a == 0.0F) | (c.a == 1.0F), 1.0F, 1.0F / pick(c.a == 0.0F, 1.0F, c.a));
        c = {c.r * by_alpha, c.g * by_alpha, c.b * by_alpha, c.a};
    }
    if (image.meaning.curved) {
        c = {linear_of(c.r), linear_of(c.g), linear_of(c.b), c.a};
    }
    return c;
}

// How a footprint is gone over: in a row of probes along its longer axis, or two such rows side by side.
struct Filter {
    Real probes, rows;
    ImageFootprint::Step along, aside; // from one to the next
    Real fine;                         // the share of the picture itself
    Real level;                        // else of this one and the next coarser
    Real low, high;                    // their shares
};

inline Filter filter_of(const ImageView &image, Interpolation interpolation, const ImageFootprint &footprint,
                        Mask asked) {
    const float width = static_cast<float>(image.width), height = static_cast<float>(image.height);
    // What is not finite reaches over everything.
    constexpr float FAR = 1e3F;
    const auto length = [asked](Real step, float size) {
        const Real sane = pick(abs(step) < FAR, step, FAR);
        return size > 1.0F ? pick(asked, sane * size, 0.0F) : Real(0.0F);
    };
    const Real ax = length(footprint.across.u, width), ay = length(footprint.across.v, height);
    const Real bx = length(footprint.up.u, width), by = length(footprint.up.v, height);
    // The matrix of second moments, twelve times the variances: its larger eigenvalue with its vector, and its smaller.
    const Real xx = ax * ax + bx * bx, yy = ay * ay + by * by, xy = ax * ay + bx * by, cross = ax * by - ay * bx;
    const Real half = 0.5F * (xx - yy), root = sqrt(half * half + xy * xy);
    const Real longer2 = 0.5F * (xx + yy) + root, shorter2 = cross * cross / max(longer2, 1e-30F);
    // A circle has no longer axis: there the pixel's own will do.
    const Mask round = root < 0.01F * longer2;
    const Real x = pick(round, ax, pick(half >= 0.0F, half + root, xy));
    const Real y = pick(round, ay, pick(half >= 0.0F, xy, root - half));
    const Real unit = 1.0F / sqrt(max(x * x + y * y, 1e-30F));
    // What is left of them after a texel's, below which nothing is filtered.
    const Real longer = max(longer2 - 1.0F, 0.0F);
    constexpr float MOST = PROBES * PROBES - 1.0F;
    Real shorter = max(max(shorter2 - 1.0F, 0.0F), (longer - MOST) * (1.0F / (1.0F + MOST / 3.0F)));
    // Means are mixed, so a level whose texels have a size has 3 (size^2 - 1) of it, and two rows a size apart 3
    // size^2.
    const Real of_texels = 3.0F * max((shorter + 3.0F) * (1.0F / 6.0F) - 1.0F, 0.0F);
    const Real aside = sqrt(max(shorter - of_texels, 0.0F) * (1.0F / 3.0F)) * unit;
    Filter out;
    out.rows = pick(shorter > 0.0F, 2.0F, 1.0F);
    shorter = of_texels;
    Real left = max(longer - shorter, 0.0F);
    // Along a row they lie a little wider apart than they mix. What is nearly round gets by with one.
    constexpr float APART = 1.3F;
    const Real size2 = 1.0F + shorter * (1.0F / 3.0F);
    out.probes =
        clamp(ceil(sqrt(1.0F + left / (size2 * (APART * APART))) - 0.15F), pick(shorter > 0.0F, 2.0F, 1.0F), PROBES);
    const Mask single = out.probes < 1.5F;
    shorter = pick(single, shorter + 0.5F * left, shorter);
    left = pick(single, 0.0F, left);
    const Real along = sqrt(left / max(out.probes * out.probes - 1.0F, 1.0F)) * unit;
    out.along = {x * along * (1.0F / width), y * along * (1.0F / height)};
    out.aside = {-y * aside * (1.0F / width), x * aside * (1.0F / height)};
    const float first = interpolation == Interpolation::CLOSEST  ? 1.0F / 12.0F
                        : interpolation == Interpolation::LINEAR ? 1.0F / 6.0F
                                                                 : 1.0F / 3.0F;
    constexpr float SECOND = 11.0F / 12.0F;
    const Real variance = first + shorter * (1.0F / 12.0F);
    if (image.levels < 2) {
        out.fine = 1.0F;
        out.level = out.low = out.high = 0.0F;
        return out;
    }
    out.fine = clamp((SECOND - variance) * (1.0F / (SECOND - first)), 0.0F, 1.0F);
    // The square of the size of a texel of that variance, and 4^level up to it.
    const Real texel2 = max(4.0F * variance + 1.0F / 3.0F, 4.0F);
    Real power = 4.0F;
    out.level = 1.0F;
    for (int level = 1; level < image.levels - 1; ++level) {
        const Mask more = texel2 >= 4.0F * power;
        if (!any_lane(more)) {
            break;
        }
        power = pick(more, 4.0F * power, power);
        out.level = out.level + pick(more, 1.0F, 0.0F);
    }
    const Mask last = out.level >= static_cast<float>(image.levels - 1);
    out.high = pick(last, 0.0F, min((texel2 / power - 1.0F) * (1.0F / 3.0F), 1.0F)) * (1.0F - out.fine);
    out.low = 1.0F - out.fine - out.high;
    return out;
}

} // namespace images

// The mean of what a picture shows over a footprint, linear; without alpha's factor. Black where the place is no
// number.
inline Rgba look_up(const ImageView &image, Interpolation interpolation, Extension extension, Real u, Real v,
                    const ImageFootprint &footprint, Mask asked) {
    using namespace images;
    const Mask sound = asked & (u - u == 0.0F) & (v - v == 0.0F);
    u = pick(sound, u, 0.0F);
    v = pick(sound, v, 0.0F);
    const Filter filter = filter_of(image, interpolation, footprint, sound);
    // Multiplied by alpha, and as they are, which is what counts where all is clear.
    Rgba sum{0.0F, 0.0F, 0.0F, 0.0F}, plain = sum;
    const auto count = [&](const Rgba &c, Real share, Real by_alpha) {
        add(sum, {c.r * by_alpha, c.g * by_alpha, c.b * by_alpha, c.a}, share);
        if (image.meaning.divided) {
            add(plain, c, share);
        }
    };
    const bool fine = any_lane(filter.fine > 0.0F), coarse = any_lane(filter.fine < 1.0F);
    const bool coarser = any_lane(filter.high > 0.0F);
    const Real one = 1.0F;
    Level low, high;
    if (coarse) {
        low = level_of(image, filter.level);
        high = level_of(image, min(filter.level + 1.0F, static_cast<float>(image.levels - 1)));
    }
    const auto probe = [&](Real along, Real aside, Real share) {
        const Real at_u = near(extension, u + along * filter.along.u + aside * filter.aside.u);
        const Real at_v = near(extension, v + along * filter.along.v + aside * filter.aside.v);
        if (fine) {
            const Rgba c = shown(image, interpolation, extension, at_u, at_v);
            count(c, share * filter.fine, image.meaning.divided ? c.a : one);
        }
        const auto add_level = [&](const Level &level, Real weight) {
            const auto fetch = [&image](Index at) { return coarse_texel(image, at); };
            count(mixed(level, linear(extension, at_u, level.width), linear(extension, at_v, level.height), fetch),
                  share * weight, one);
        };
        if (coarse) {
            add_level(low, filter.low);
        }
        if (coarser) {
            add_level(high, filter.high);
        }
    };
    const float probes = highest(filter.probes), rows = highest(filter.rows);
    for (float row = 0.0F; row < rows; row += 1.0F) {
        const Real of_row = pick(filter.rows > row, 1.0F / (filter.probes * filter.rows), 0.0F);
        for (float number = 0.0F; number < probes; number += 1.0F) {
            probe(number - 0.5F * (filter.probes - 1.0F), row - 0.5F * (filter.rows - 1.0F),
                  pick(filter.probes > number, of_row, 0.0F));
        }
    }
    if (image.meaning.divided) {
        const Mask seen = sum.a > 0.0F;
        const Real by = 1.0F / pick(seen, sum.a, 1.0F);
        sum = {pick(seen, sum.r * by, plain.r), pick(seen, sum.g * by, plain.g), pick(seen, sum.b * by, plain.b),
               sum.a};
    }
    const Real kept = pick(sound, 1.0F, 0.0F);
    return scaled(sum, kept);
}

} // namespace
} // namespace sfumato::SFUMATO_ISA
