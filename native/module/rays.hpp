// SPDX-License-Identifier: GPL-3.0-or-later
// Light rays as Python hands them over: any leading axes, then the absorbers of one ray.
#pragma once

#include "module/arguments.hpp"
#include "rays/basis.hpp"

#include <optional>

namespace sfumato::arguments {

using Bytes = py::array_t<std::uint8_t, py::array::c_style>;
using OptionalFloats = std::optional<Floats>;

template <typename Array>
std::vector<py::ssize_t> batch_of(const Array &array, const std::string &name) {
    if (array.ndim() < 1) {
        throw py::value_error(name + " is a single number, but must have at least one axis");
    }
    return {array.shape(), array.shape() + array.ndim() - 1};
}

inline std::size_t product(const std::vector<py::ssize_t> &shape) {
    std::size_t out = 1;
    for (const py::ssize_t size : shape) {
        out *= static_cast<std::size_t>(size);
    }
    return out;
}

template <typename Array>
std::size_t last_axis(const Array &array) {
    return static_cast<std::size_t>(array.shape(array.ndim() - 1));
}

// `text` as an index into names, or a refusal that lists them.
template <std::size_t N>
std::size_t one_of(const std::string &given, const std::array<const char *, N> &names, const std::string &name) {
    std::string all;
    for (std::size_t i = 0; i < N; ++i) {
        if (given == names[i]) {
            return i;
        }
        all += (i > 0 ? ", " : "") + std::string("'") + names[i] + "'";
    }
    throw py::value_error(name + " is '" + given + "', but must be one of " + all);
}

inline RangeKind range_kind(const std::string &kind) {
    return static_cast<RangeKind>(one_of<5>(kind, {"whole", "minmax", "moments", "both", "trimmed"}, "kind"));
}

inline void require_coefficients(const Basis &basis, std::size_t count) {
    if (count < 1 || (basis.odd && count % 2 == 0)) {
        throw py::value_error("coefficients is " + std::to_string(count) + ", but must be " +
                              (basis.odd ? "odd and at least 1: a constant and pairs of harmonics" : "at least 1"));
    }
}

// Checked absorbers of many rays.
struct Rays {
    Rays(const py::object &depth, const py::object &optical_depth, float slab_width)
        : given(any_array(depth, "depth")), z(given), tau(any_array(optical_depth, "optical_depth")), width(slab_width),
          shape(batch_of(z, "depth")) {
        if (z.ndim() != tau.ndim() || !std::equal(z.shape(), z.shape() + z.ndim(), tau.shape())) {
            throw py::value_error("optical_depth has shape " + shape_of(tau) + ", but must have that of depth, " +
                                  shape_of(z));
        }
        require_range(z, 0.0F, 1.0F, "depth");
        require_range(tau, 0.0F, 1e30F, "optical_depth");
        require_range(width, 0.0F, 1.0F, "width");
        count = product(shape);
    }
    [[nodiscard]] Absorbers at(std::size_t ray) const {
        const std::size_t n = last_axis(z);
        return {{z.data() + ray * n, n}, {tau.data() + ray * n, n}, width};
    }
    [[nodiscard]] std::vector<Absorbers> all() const {
        std::vector<Absorbers> out;
        for (std::size_t ray = 0; ray < count; ++ray) {
            out.push_back(at(ray));
        }
        return out;
    }
    [[nodiscard]] std::vector<py::ssize_t> shape_with(std::size_t size) const {
        auto out = shape;
        out.push_back(static_cast<py::ssize_t>(size));
        return out;
    }

    py::array given; // depth, in the precision that it came in
    Floats z, tau;
    float width;
    std::vector<py::ssize_t> shape;
    std::size_t count = 0;
};

// The range of every ray: given, or the whole depth.
inline std::vector<Range> ranges_of(const OptionalFloats &range, const std::vector<py::ssize_t> &batch) {
    std::vector<Range> out(product(batch));
    if (!range) {
        return out;
    }
    auto wanted = batch;
    wanted.push_back(2);
    if (range->ndim() != static_cast<py::ssize_t>(wanted.size()) ||
        !std::equal(wanted.begin(), wanted.end(), range->shape())) {
        throw py::value_error("range has shape " + shape_of(*range) +
                              ", but must have the axes of the rays, then 2: low and high");
    }
    require_finite(*range, "range");
    for (std::size_t ray = 0; ray < out.size(); ++ray) {
        const float *pair = range->data() + 2 * ray;
        if (pair[0] > pair[1]) {
            throw py::value_error("range holds " + text(pair[0]) + " before " + text(pair[1]) + " for ray " +
                                  std::to_string(ray) + ", but low must not exceed high");
        }
        out[ray] = {pair[0], pair[1]};
    }
    return out;
}

inline void require_same_batch(const std::vector<py::ssize_t> &shape, const std::string &name, const Floats &depth) {
    if (batch_of(depth, "depth") != shape) {
        throw py::value_error("depth has shape " + shape_of(depth) +
                              ", but all axes other than the last must be those of " + name);
    }
}

} // namespace sfumato::arguments
