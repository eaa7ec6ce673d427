// SPDX-License-Identifier: GPL-3.0-or-later
// What Python hands over, checked: every refusal names the argument and its value.
#pragma once

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

namespace sfumato::arguments {

namespace py = pybind11;

// Any real array; float32 in C order is used as it is, anything else is converted once.
using Floats = py::array_t<float, py::array::c_style | py::array::forcecast>;
using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

// A value in a few words on one line: what a message says of it.
inline std::string told(const py::handle &value) {
    constexpr py::ssize_t LONGEST = 60;
    if (py::isinstance<py::array>(value)) {
        const auto array = py::reinterpret_borrow<py::array>(value);
        return "an array of " + std::string(py::str(array.dtype())) + " of shape " +
               std::string(py::str(array.attr("shape")));
    }
    const py::object words = py::repr(value).attr("replace")("\n", " "); // cut by letters, not by bytes
    const bool is_long = py::len(words) > LONGEST;
    return std::string(py::str(is_long ? words[py::slice(0, LONGEST, 1)] : words)) + (is_long ? "..." : "");
}

// Anything that NumPy makes an array of, in the precision that it came in.
inline py::array any_array(const py::object &given, const std::string &name) {
    py::array array = py::array::ensure(given);
    if (!array || std::string_view("fiub").find(array.dtype().kind()) == std::string_view::npos) {
        throw py::value_error(name + " is " + told(given) + ", but must be an array of real numbers");
    }
    return array;
}

// The shortest text that reads back as the same number.
template <typename Number>
std::string text(Number value) {
    std::array<char, 32> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
    return {digits.data(), end};
}

template <typename Array>
std::string shape_of(const Array &array) {
    std::string out = "(";
    for (py::ssize_t axis = 0; axis < array.ndim(); ++axis) {
        out += (axis > 0 ? ", " : "") + text(array.shape(axis));
    }
    return out + (array.ndim() == 1 ? ",)" : ")");
}

// A size of -1 stands for any.
template <typename Array>
void require_shape(const Array &array, std::initializer_list<py::ssize_t> shape, const std::string &name) {
    bool fits = array.ndim() == static_cast<py::ssize_t>(shape.size());
    std::string wanted;
    py::ssize_t axis = 0;
    for (const py::ssize_t size : shape) {
        fits = fits && (size < 0 || array.shape(axis) == size);
        wanted += (axis > 0 ? ", " : "") + (size < 0 ? "any" : text(size));
        ++axis;
    }
    if (!fits) {
        throw py::value_error(name + " has shape " + shape_of(array) + ", but must have (" + wanted +
                              (axis == 1 ? ",)" : ")"));
    }
}

template <typename Array>
void require_finite(const Array &array, const std::string &name) {
    const auto *values = array.data();
    for (py::ssize_t i = 0; i < array.size(); ++i) {
        if (!std::isfinite(values[i])) {
            throw py::value_error(name + " holds " + text(values[i]) + " at flat index " + text(i) +
                                  "; every value must be finite");
        }
    }
}

template <typename Number>
void require_range(Number value, Number low, Number high, const std::string &name) {
    if (!(value >= low && value <= high)) {
        throw py::value_error(name + " is " + text(value) + ", but must lie between " + text(low) + " and " +
                              text(high));
    }
}

template <typename Number, int Flags>
void require_range(const py::array_t<Number, Flags> &array, std::type_identity_t<Number> low,
                   std::type_identity_t<Number> high, const std::string &name) {
    const Number *values = array.data();
    for (py::ssize_t i = 0; i < array.size(); ++i) {
        if (!(values[i] >= low && values[i] <= high)) {
            throw py::value_error(name + " holds " + text(values[i]) + " at flat index " + text(i) +
                                  "; every value must lie between " + text(low) + " and " + text(high));
        }
    }
}

// Of refraction: 0 asks for Schlick's curve, and no material that reflects as a dielectric has more than 1000.
constexpr const char *INDEX_RANGE = "0 or lie between 1 and 1000";
inline bool is_index(double value) {
    return value == 0.0 || (value >= 1.0 && value <= 1000.0);
}

// Indices into something that has `count` members. Doubles hold every index that fits in memory, and, unlike
// integers, what a caller wrote by mistake.
inline std::vector<std::uint32_t> indices(const Doubles &array, py::ssize_t count, const std::string &name) {
    std::vector<std::uint32_t> out;
    out.reserve(static_cast<std::size_t>(array.size()));
    for (py::ssize_t i = 0; i < array.size(); ++i) {
        const double value = array.data()[i];
        if (!(value >= 0.0 && value < static_cast<double>(count) && value == std::floor(value))) {
            throw py::value_error(name + " holds " + text(value) + " at flat index " + text(i) +
                                  "; every value must be one of the " + text(count) + " indices from 0");
        }
        out.push_back(static_cast<std::uint32_t>(value));
    }
    return out;
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

// Its last row, the flat indices of which begin at `first`, must be that of an affine matrix.
inline void require_affine(const glm::mat4 &m, py::ssize_t first, const std::string &name) {
    for (int column = 0; column < 4; ++column) {
        if (m[column][3] != (column == 3 ? 1.0F : 0.0F)) {
            throw py::value_error(name + " holds " + text(m[column][3]) + " at flat index " +
                                  text(first + 12 + column) + "; its last row must be 0, 0, 0, 1");
        }
    }
}

inline glm::mat4 affine_matrix(const Doubles &array, const std::string &name) {
    const glm::mat4 m(matrix4(array, name));
    require_affine(m, 0, name);
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
template <typename Number>
py::array_t<Number> to_numpy(std::vector<Number> values, std::vector<py::ssize_t> shape) {
    using Values = std::vector<Number>;
    auto owner = std::make_unique<Values>(std::move(values));
    const Number *data = owner->data();
    const py::capsule keep(owner.get(), [](void *p) { std::unique_ptr<Values>(static_cast<Values *>(p)); });
    static_cast<void>(owner.release()); // the capsule owns it now
    return py::array_t<Number>(std::move(shape), data, keep);
}

// The result keeps the caller's precision.
inline py::object as_given(const py::array &given, const py::array_t<float> &result) {
    return given.dtype().is(py::dtype::of<double>()) ? result.attr("astype")(py::dtype::of<double>())
                                                     : py::object(result);
}

} // namespace sfumato::arguments
