// SPDX-License-Identifier: GPL-3.0-or-later
// What Python hands over, checked: every refusal names the argument and its value.
#pragma once

#include <cmath>
#include <initializer_list>
#include <span>
#include <string>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

namespace sfumato::arguments {

namespace py = pybind11;

// Any real array; float32 in C order is used as it is, anything else is converted once.
using Floats = py::array_t<float, py::array::c_style | py::array::forcecast>;
using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Integers = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>;

template <typename Array>
std::string shape_of(const Array &array) {
    std::string text = "(";
    for (py::ssize_t axis = 0; axis < array.ndim(); ++axis) {
        text += (axis > 0 ? ", " : "") + std::to_string(array.shape(axis));
    }
    return text + ")";
}

// A size of -1 stands for any.
template <typename Array>
void require_shape(const Array &array, std::initializer_list<py::ssize_t> shape, const std::string &name) {
    bool fits = array.ndim() == static_cast<py::ssize_t>(shape.size());
    std::string wanted;
    py::ssize_t axis = 0;
    for (const py::ssize_t size : shape) {
        fits = fits && (size < 0 || array.shape(axis) == size);
        wanted += (axis > 0 ? ", " : "") + (size < 0 ? std::string("any") : std::to_string(size));
        ++axis;
    }
    if (!fits) {
        throw py::value_error(name + " has shape " + shape_of(array) + ", but must have (" + wanted + ")");
    }
}

template <typename Array>
void require_finite(const Array &array, const std::string &name) {
    const auto *values = array.data();
    for (py::ssize_t i = 0; i < array.size(); ++i) {
        if (!std::isfinite(values[i])) {
            throw py::value_error(name + " holds " + std::to_string(values[i]) + " at flat index " + std::to_string(i) +
                                  "; every value must be finite");
        }
    }
}

template <typename Number>
void require_range(Number value, Number low, Number high, const std::string &name) {
    if (!(value >= low && value <= high)) {
        throw py::value_error(name + " is " + std::to_string(value) + ", but must lie between " + std::to_string(low) +
                              " and " + std::to_string(high));
    }
}

inline void require_range(const Floats &array, float low, float high, const std::string &name) {
    require_finite(array, name);
    for (py::ssize_t i = 0; i < array.size(); ++i) {
        require_range(array.data()[i], low, high, name);
    }
}

inline glm::vec3 vector3(const Floats &array, const std::string &name) {
    require_shape(array, {3}, name);
    require_finite(array, name);
    return {array.data()[0], array.data()[1], array.data()[2]};
}

// NumPy's rows become GLM's columns.
inline glm::dmat4 matrix4(const Doubles &array, const std::string &name) {
    require_shape(array, {4, 4}, name);
    require_finite(array, name);
    glm::dmat4 m;
    for (int row = 0; row < 4; ++row) {
        for (int column = 0; column < 4; ++column) {
            m[column][row] = array.data()[4 * row + column];
        }
    }
    return m;
}

inline py::array_t<double> to_numpy(const glm::dmat4 &m) {
    py::array_t<double> out({4, 4});
    for (int row = 0; row < 4; ++row) {
        for (int column = 0; column < 4; ++column) {
            out.mutable_at(row, column) = m[column][row];
        }
    }
    return out;
}

inline py::array_t<float> to_numpy(const glm::vec3 &v) {
    py::array_t<float> out(3);
    for (int axis = 0; axis < 3; ++axis) {
        out.mutable_at(axis) = v[axis];
    }
    return out;
}

// The vector's own memory as an array of the given shape, without a copy.
inline py::array_t<float> to_numpy(std::vector<float> values, std::vector<py::ssize_t> shape) {
    auto owner = std::make_unique<std::vector<float>>(std::move(values));
    const float *data = owner->data();
    const py::capsule keep(owner.get(),
                           [](void *p) { std::unique_ptr<std::vector<float>>(static_cast<std::vector<float> *>(p)); });
    static_cast<void>(owner.release()); // the capsule owns it now
    return py::array_t<float>(std::move(shape), data, keep);
}

} // namespace sfumato::arguments
