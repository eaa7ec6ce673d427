// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures on surfaces, as lanes look them up: each with a pyramid of means of itself, every level half as fine.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace sfumato {

// How texels become colours.
struct ImageMeaning {
    // Colours are written with sRGB's curve. Between texels they are mixed as they are written, and decoded then: that
    // is how it looks up close. Means are of that light.
    bool curved = false;
    // Colours are multiplied by alpha, as they are written, and what is looked up is divided by it. Then what is clear
    // has no say in the colours of means. Else alpha is a fourth channel, of which colours know nothing.
    bool divided = false;
    // Nothing is mixed between texels, so that means are of the texels alone.
    bool closest = false;
};

enum class Interpolation : std::uint8_t { CLOSEST, LINEAR, CUBIC };
enum class Extension : std::uint8_t { REPEAT, EXTEND, CLIP, MIRROR };

// Owns nothing. Rows from the bottom up, texels of four channels.
struct ImageView {
    // One of the two, of all levels one after another. Of bytes the first channel is the lowest of an integer, and the
    // levels after the first are never multiplied by alpha; of floats they are linear, and multiplied where `divided`.
    const std::int32_t *bytes = nullptr;
    const float *floats = nullptr;
    // Of each level: where it begins, in texels; columns; rows. In this order, LEVELS of each.
    const std::int32_t *starts = nullptr;
    int width = 0, height = 0;
    int levels = 0; // the last is a single texel
    ImageMeaning meaning;
};

// Never changes once it is made. (Image is what a frame makes.)
class SurfaceImage {
public:
    static constexpr int LEVELS = 32;
    // Of all levels an integer counts the bytes' texels, and the floats' channels.
    static constexpr std::int64_t MOST_BYTES = std::int64_t{1} << 30, MOST_FLOATS = std::int64_t{1} << 28;

    // (height, width, 4); floats must be finite.
    SurfaceImage(int width, int height, std::span<const std::uint8_t> texels, ImageMeaning meaning);
    SurfaceImage(int width, int height, std::span<const float> texels, ImageMeaning meaning);

    [[nodiscard]] ImageView view() const;

private:
    void lay_out(int width, int height, ImageMeaning meaning);
    template <typename Written, typename Store>
    void make_levels(const Written &written, const Store &store) const;

    std::vector<std::int32_t> bytes_;
    std::vector<float> floats_;
    std::vector<std::int32_t> starts_;
    int width_ = 0, height_ = 0, levels_ = 0;
    ImageMeaning meaning_;
};

} // namespace sfumato
