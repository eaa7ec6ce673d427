// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures beside formulas of their own, one place at a time in doubles: what is between texels, and means over
// footprints by many points.
#include "textures/image_kernels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <gtest/gtest.h>

namespace sfumato {
namespace {

struct Place {
    glm::dvec2 at, across{0.0}, up{0.0};
};

std::vector<glm::dvec4> found(const SurfaceImage &image, Interpolation interpolation, Extension extension,
                              const std::vector<Place> &places, const InstructionSet &with = instruction_set()) {
    std::vector<float> u, v, across, up, rgba(4 * places.size());
    for (const Place &place : places) {
        u.push_back(static_cast<float>(place.at.x));
        v.push_back(static_cast<float>(place.at.y));
        for (const glm::dvec2 *step : {&place.across, &place.up}) {
            std::vector<float> &to = step == &place.across ? across : up;
            to.push_back(static_cast<float>(step->x));
            to.push_back(static_cast<float>(step->y));
        }
    }
    image_kernels(with).look_up_all(image.view(), interpolation, extension,
                                    {places.size(), u.data(), v.data(), across.data(), up.data(), rgba.data()});
    std::vector<glm::dvec4> out;
    for (std::size_t i = 0; i < places.size(); ++i) {
        out.emplace_back(rgba[4 * i], rgba[4 * i + 1], rgba[4 * i + 2], rgba[4 * i + 3]);
    }
    return out;
}

struct Texels {
    int width, height;
    std::vector<std::uint8_t> bytes;

    [[nodiscard]] SurfaceImage image(ImageMeaning meaning) const { return {width, height, bytes, meaning}; }
    [[nodiscard]] std::vector<float> floats() const {
        std::vector<float> out;
        for (const std::uint8_t byte : bytes) {
            out.push_back(static_cast<float>(byte) / 255.0F);
        }
        return out;
    }
};

// Without colour where there is no alpha, and never more of it.
Texels noise(int width, int height, bool clear = false) {
    std::mt19937 random(7);
    Texels out{width, height, {}};
    std::uniform_int_distribution<int> byte(0, 255);
    for (int i = 0; i < width * height; ++i) {
        const int alpha = clear ? std::clamp(2 * byte(random) - 128, 0, 255) : 255;
        for (int channel = 0; channel < 3; ++channel) {
            out.bytes.push_back(static_cast<std::uint8_t>(byte(random) * alpha / 255));
        }
        out.bytes.push_back(static_cast<std::uint8_t>(alpha));
    }
    return out;
}

// Squares of 8 texels, in a colour that rises over the picture.
Texels tiles(int size) {
    Texels out{size, size, {}};
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            const int value = (x / 8 + y / 8) % 2 == 0 ? 40 : 220 - 100 * x / size;
            for (const int channel : {value, value / 2, 255 - value, 255}) {
                out.bytes.push_back(static_cast<std::uint8_t>(channel));
            }
        }
    }
    return out;
}

double decoded(double x) {
    return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
}

// -1 for none.
int wrapped(Extension extension, int number, int size) {
    const int turn = (number % (2 * size) + 2 * size) % (2 * size);
    switch (extension) {
    case Extension::REPEAT:
        return turn % size;
    case Extension::MIRROR:
        return turn < size ? turn : 2 * size - 1 - turn;
    case Extension::EXTEND:
        return std::clamp(number, 0, size - 1);
    default:
        return number < 0 || number >= size ? -1 : number;
    }
}

std::vector<double> weights(Interpolation interpolation, double t) {
    if (interpolation == Interpolation::LINEAR) {
        return {0.0, 1.0 - t, t, 0.0};
    }
    const auto spline = [](double x) { // about 0
        x = std::abs(x);
        return x < 1.0 ? 2.0 / 3.0 - x * x * (1.0 - 0.5 * x) : std::pow(2.0 - x, 3.0) / 6.0;
    };
    return {spline(1.0 + t), spline(t), spline(1.0 - t), spline(2.0 - t)};
}

// Decoded, without alpha's factor.
glm::dvec4 shown(const Texels &texels, ImageMeaning meaning, Interpolation interpolation, Extension extension,
                 const glm::dvec2 &at) {
    glm::dvec4 sum(0.0);
    const auto add = [&](int x, int y, double weight) {
        x = wrapped(extension, x, texels.width);
        y = wrapped(extension, y, texels.height);
        if (x >= 0 && y >= 0) {
            const std::uint8_t *four = &texels.bytes[static_cast<std::size_t>(4 * (y * texels.width + x))];
            sum += weight / 255.0 * glm::dvec4(four[0], four[1], four[2], four[3]);
        }
    };
    if (interpolation == Interpolation::CLOSEST) {
        add(static_cast<int>(std::floor(at.x * texels.width)), static_cast<int>(std::floor(at.y * texels.height)), 1.0);
    } else {
        const double x = at.x * texels.width - 0.5, y = at.y * texels.height - 0.5;
        const std::vector<double> columns = weights(interpolation, x - std::floor(x)),
                                  rows = weights(interpolation, y - std::floor(y));
        for (int j = 0; j < 4; ++j) {
            for (int i = 0; i < 4; ++i) {
                add(static_cast<int>(std::floor(x)) + i - 1, static_cast<int>(std::floor(y)) + j - 1,
                    columns[static_cast<std::size_t>(i)] * rows[static_cast<std::size_t>(j)]);
            }
        }
    }
    if (meaning.divided && sum.w > 0.0) {
        sum = {sum.x / sum.w, sum.y / sum.w, sum.z / sum.w, sum.w};
    }
    return meaning.curved ? glm::dvec4(decoded(sum.x), decoded(sum.y), decoded(sum.z), sum.w) : sum;
}

glm::dvec4 mean(const Texels &texels, ImageMeaning meaning, Interpolation interpolation, Extension extension,
                const Place &place) {
    constexpr int SIDE = 40;
    glm::dvec4 sum(0.0), plain(0.0);
    for (int j = 0; j < SIDE; ++j) {
        for (int i = 0; i < SIDE; ++i) {
            const glm::dvec2 at =
                place.at + place.across * ((i + 0.5) / SIDE - 0.5) + place.up * ((j + 0.5) / SIDE - 0.5);
            const glm::dvec4 c = shown(texels, meaning, interpolation, extension, at);
            plain += c / double(SIDE * SIDE);
            sum += glm::dvec4(c.x * c.w, c.y * c.w, c.z * c.w, c.w) / double(SIDE * SIDE);
        }
    }
    return meaning.divided && sum.w > 0.0 ? glm::dvec4(sum.x / sum.w, sum.y / sum.w, sum.z / sum.w, sum.w) : plain;
}

double most_of(const glm::dvec4 &v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z), std::abs(v.w)});
}

constexpr std::array EXTENSIONS{Extension::REPEAT, Extension::EXTEND, Extension::CLIP, Extension::MIRROR};
constexpr std::array INTERPOLATIONS{Interpolation::CLOSEST, Interpolation::LINEAR, Interpolation::CUBIC};

TEST(Image, BetweenTexelsItIsTheFormula) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> anywhere(-1.7, 2.7);
    for (const auto &[width, height] : {std::pair(1, 1), {1, 7}, {3, 5}, {2, 1}, {16, 12}}) {
        for (const bool curved : {false, true}) {
            for (const bool divided : {false, true}) {
                const ImageMeaning meaning{curved, divided};
                const Texels texels = noise(width, height, divided);
                const SurfaceImage bytes = texels.image(meaning), floats(width, height, texels.floats(), meaning);
                std::vector<Place> places;
                for (int i = 0; i < 300; ++i) {
                    places.push_back({{anywhere(random), anywhere(random)}});
                }
                for (const Interpolation interpolation : INTERPOLATIONS) {
                    for (const Extension extension : EXTENSIONS) {
                        for (const InstructionSet &with : instruction_sets()) {
                            for (const SurfaceImage *image : {&bytes, &floats}) {
                                const auto all = found(*image, interpolation, extension, places, with);
                                for (std::size_t i = 0; i < places.size(); ++i) {
                                    const glm::dvec4 wanted =
                                        shown(texels, meaning, interpolation, extension, places[i].at);
                                    // What is almost clear is divided by almost nothing.
                                    const double most = divided && wanted.w < 0.02 ? 0.05 : 1e-4;
                                    ASSERT_LT(most_of(all[i] - wanted), most) << width << " x " << height;
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

// Of light, and of alpha; where that counts, colours are weighed by it.
TEST(Image, EachLevelHasTheMeanOfThePicture) {
    for (const auto &[width, height] : {std::pair(1, 7), {3, 5}, {64, 64}, {37, 101}, {1025, 3}, {5, 600}}) {
        for (const bool divided : {false, true}) {
            const Texels texels = noise(width, height, divided);
            const ImageMeaning meaning{true, divided, true};
            const SurfaceImage image(width, height, texels.floats(), meaning);
            const ImageView view = image.view();
            glm::dvec4 wanted(0.0);
            for (int y = 0; y < height; ++y) {
                for (int x = 0; x < width; ++x) {
                    const glm::dvec4 c = shown(texels, meaning, Interpolation::CLOSEST, Extension::REPEAT,
                                               {(x + 0.5) / width, (y + 0.5) / height});
                    const double by = divided ? c.w : 1.0;
                    wanted += glm::dvec4(c.x * by, c.y * by, c.z * by, c.w) / double(width * height);
                }
            }
            for (int level = 1; level < view.levels; ++level) {
                const int columns = view.starts[level + SurfaceImage::LEVELS],
                          rows = view.starts[level + 2 * SurfaceImage::LEVELS];
                EXPECT_EQ(columns, std::max(1, (width + (1 << level) - 1) >> level));
                EXPECT_EQ(rows, std::max(1, (height + (1 << level) - 1) >> level));
                glm::dvec4 sum(0.0);
                for (int i = 0; i < columns * rows; ++i) {
                    const float *four = view.floats + 4 * (view.starts[level] + i);
                    sum += glm::dvec4(four[0], four[1], four[2], four[3]) / double(columns * rows);
                }
                EXPECT_LT(most_of(sum - wanted), 2e-6) << width << " x " << height << ", level " << level;
            }
        }
    }
}

// A ramp's means lie where they are of.
TEST(Image, OddSizesShiftNothing) {
    std::vector<float> ramp;
    constexpr int WIDTH = 101;
    for (int x = 0; x < WIDTH; ++x) {
        const auto value = static_cast<float>(x + 0.5) / WIDTH;
        ramp.insert(ramp.end(), {value, value, value, 1.0F});
    }
    const SurfaceImage image(WIDTH, 1, ramp, {});
    for (const double size : {0.05, 0.1, 0.2}) {
        std::vector<Place> places;
        for (double u = 0.3; u < 0.7; u += 0.01) {
            places.push_back({{u, 0.5}, {size, 0.0}, {0.0, size}});
        }
        const auto all = found(image, Interpolation::LINEAR, Extension::EXTEND, places);
        for (std::size_t i = 0; i < all.size(); ++i) {
            EXPECT_NEAR(all[i].x, places[i].at.x, 2e-3) << size;
        }
    }
}

std::vector<Place> footprints(int size, double width, double anisotropy, int count) {
    std::mt19937 random(static_cast<unsigned>(100.0 * width + anisotropy));
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::vector<Place> out;
    for (int i = 0; i < count; ++i) {
        const double angle = 2.0 * std::numbers::pi * unit(random), across = width * anisotropy / size;
        out.push_back({{3.0 * unit(random) - 1.0, 3.0 * unit(random) - 1.0},
                       across * glm::dvec2(std::cos(angle), std::sin(angle)),
                       width / size * glm::dvec2(-std::sin(angle), std::cos(angle))});
    }
    return out;
}

// The root of the mean square over footprints.
double error(const Texels &texels, ImageMeaning meaning, Interpolation interpolation, Extension extension,
             const std::vector<Place> &places) {
    const auto all = found(texels.image(meaning), interpolation, extension, places);
    double sum = 0.0;
    for (std::size_t i = 0; i < places.size(); ++i) {
        const glm::dvec4 wanted = mean(texels, meaning, interpolation, extension, places[i]);
        // Colours count as much as they are seen.
        const glm::dvec4 off = (all[i] - wanted) * (meaning.divided ? wanted.w : 1.0);
        sum += glm::dot(off, off) / 4.0;
    }
    return std::sqrt(sum / static_cast<double>(places.size()));
}

TEST(Image, FootprintsAreMeans) {
    for (const double anisotropy : {1.0, 2.0, 5.0, 16.0}) {
        for (const double width : {1.5, 3.0, 7.0}) {
            const auto places = footprints(128, width, anisotropy, 100);
            const auto all = [&](const Texels &texels, ImageMeaning meaning, Interpolation interpolation) {
                return error(texels, meaning, interpolation, Extension::REPEAT, places);
            };
            const Texels worst = noise(128, 128), soft = noise(128, 128, true), usual = tiles(128);
            EXPECT_LT(all(worst, {}, Interpolation::LINEAR), 0.035) << anisotropy << ", " << width;
            EXPECT_LT(all(worst, {true}, Interpolation::LINEAR), 0.035) << anisotropy << ", " << width;
            EXPECT_LT(all(worst, {true}, Interpolation::CUBIC), 0.035) << anisotropy << ", " << width;
            EXPECT_LT(all(soft, {true, true}, Interpolation::LINEAR), 0.05) << anisotropy << ", " << width;
            EXPECT_LT(all(usual, {true}, Interpolation::LINEAR), 0.06) << anisotropy << ", " << width;
            EXPECT_LT(all(worst, {true, false, true}, Interpolation::CLOSEST), 0.08) << anisotropy << ", " << width;
        }
    }
}

// Round ones too, where rounding alone would tell which axis is the longer.
TEST(Image, EveryInstructionSetFiltersAlike) {
    const SurfaceImage image = noise(64, 64).image({true});
    for (const double anisotropy : {1.0, 1.004, 1.3, 6.0}) {
        const auto places = footprints(64, 3.0, anisotropy, 400);
        const auto first = found(image, Interpolation::LINEAR, Extension::REPEAT, places, instruction_sets().front());
        for (const InstructionSet &with : instruction_sets()) {
            const auto all = found(image, Interpolation::LINEAR, Extension::REPEAT, places, with);
            for (std::size_t i = 0; i < all.size(); ++i) {
                EXPECT_LT(most_of(all[i] - first[i]), 1e-3) << anisotropy;
            }
        }
    }
}

TEST(Image, ClippedItEndsWithinAPixelOfItsEdge) {
    Texels white{32, 32, std::vector<std::uint8_t>(std::size_t{4} * 32 * 32, 255)};
    for (const double width : {2.0, 4.0}) {
        std::vector<Place> places = footprints(32, width, 1.0, 200);
        EXPECT_LT(error(white, {true, true}, Interpolation::LINEAR, Extension::CLIP, places), 0.04) << width;
    }
}

// Divided by less than they are, colours are brighter than white; bytes of means end there.
TEST(Image, MoreColourThanAlphaIsNoTrouble) {
    Texels texels = noise(9, 9);
    for (std::size_t i = 3; i < texels.bytes.size(); i += 4) {
        texels.bytes[i] = static_cast<std::uint8_t>(i % 7);
    }
    for (const bool curved : {false, true}) {
        const SurfaceImage image = texels.image({curved, true});
        for (const glm::dvec4 &each :
             found(image, Interpolation::LINEAR, Extension::REPEAT, footprints(9, 3.0, 2.0, 50))) {
            EXPECT_TRUE(std::isfinite(each.x + each.y + each.z + each.w));
        }
    }
}

// All that it shows is one colour, however it is gone over, and exactly that of the byte.
TEST(Image, OneColourStaysThat) {
    Texels one{33, 17, {}};
    for (int i = 0; i < 33 * 17; ++i) {
        one.bytes.insert(one.bytes.end(), {100, 20, 80, 128});
    }
    std::vector<Place> places;
    for (const double width : {0.1, 1.0, 1.5, 3.0, 11.0, 500.0}) {
        for (const double anisotropy : {1.0, 1.3, 4.0, 100.0}) {
            const auto more = footprints(33, width, anisotropy, 20);
            places.insert(places.end(), more.begin(), more.end());
        }
    }
    for (const bool curved : {false, true}) {
        for (const bool divided : {false, true}) {
            for (const Interpolation interpolation : INTERPOLATIONS) {
                const ImageMeaning meaning{curved, divided};
                const SurfaceImage floats(33, 17, one.floats(), meaning), bytes = one.image(meaning);
                for (const Extension extension : {Extension::REPEAT, Extension::EXTEND, Extension::MIRROR}) {
                    const glm::dvec4 wanted = shown(one, meaning, interpolation, extension, {0.0, 0.0});
                    for (const glm::dvec4 &each : found(floats, interpolation, extension, places)) {
                        ASSERT_LT(most_of(each - wanted), 5e-5);
                    }
                    for (const glm::dvec4 &each : found(bytes, interpolation, extension, places)) {
                        ASSERT_LT(most_of(each - wanted), divided ? 3e-3 : 5e-5);
                    }
                }
            }
        }
    }
}

TEST(Image, WhatIsNoPlaceIsBlack) {
    constexpr double INFINITE = std::numeric_limits<double>::infinity(),
                     NONE = std::numeric_limits<double>::quiet_NaN();
    const Texels texels = noise(5, 3);
    const std::vector<Place> places{{{NONE, 0.5}},
                                    {{0.5, -INFINITE}},
                                    {{1e6, -1e6}},
                                    {{1e30, -1e38}},
                                    {{0.5, 0.5}, {NONE, 0.0}, {0.0, INFINITE}},
                                    {{0.5, 0.5}, {1e30, 1e-30}, {-1e30, 1e20}}};
    for (const Interpolation interpolation : INTERPOLATIONS) {
        for (const Extension extension : EXTENSIONS) {
            for (const InstructionSet &with : instruction_sets()) {
                const auto all = found(texels.image({true}), interpolation, extension, places, with);
                EXPECT_EQ(most_of(all[0]) + most_of(all[1]), 0.0);
                for (const glm::dvec4 &each : all) {
                    EXPECT_TRUE(std::isfinite(each.x + each.y + each.z + each.w));
                    EXPECT_TRUE(most_of(each) <= 1.0001);
                }
                if (extension == Extension::REPEAT) { // all of it
                    const glm::dvec4 whole =
                        mean(texels, {true}, Interpolation::LINEAR, extension, {{0.5, 0.5}, {1.0, 0.0}, {0.0, 1.0}});
                    EXPECT_LT(most_of(all[4] - whole), 0.05);
                }
            }
        }
    }
}

} // namespace
} // namespace sfumato
