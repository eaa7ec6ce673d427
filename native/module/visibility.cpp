// SPDX-License-Identifier: GPL-3.0-or-later
// What objects are to the camera and to lights, checked.
#include "scene/visibility.hpp"

#include "module/arguments.hpp"
#include "module/parts.hpp"

#include <string>

namespace sfumato {
namespace {

using namespace arguments;

constexpr LightSets ALL = ~LightSets{0};

Seen seen_from(const std::string &name) {
    if (name == "shown") {
        return Seen::SHOWN;
    }
    if (name == "holdout") {
        return Seen::HOLDOUT;
    }
    if (name == "catcher") {
        return Seen::CATCHER;
    }
    if (name == "unseen") {
        return Seen::UNSEEN;
    }
    throw py::value_error("seen is '" + name + "', but must be 'shown', 'holdout', 'catcher' or 'unseen'");
}

// pybind11's own refusal does not say what is wrong with -1 or 2^64.
LightSets sets_from(const py::int_ &value, const char *name) {
    const unsigned long long bits = PyLong_AsUnsignedLongLong(value.ptr());
    if (PyErr_Occurred() != nullptr) {
        PyErr_Clear();
        throw py::value_error(std::string(name) + " is " + std::string(py::repr(value)) +
                              ", but must be 64 bits: from 0 to 2**64 - 1");
    }
    return bits;
}

} // namespace

void bind_visibility(py::module_ &m) {
    py::class_<Visibility>(m, "Visibility", R"(What an object is to the camera and to lights.

seen: 'shown'; 'holdout', which cuts a hole into the picture; 'catcher', which shows nothing but the shadows that all but
other catchers throw on it, as alpha; or 'unseen'. lit_by, hides: sets of lights, a bit each. A light reaches an object
that has one of its sets in lit_by, and is hidden from others by one that has one of those that hide it in hides: Reach.
Raises ValueError for other names, and for more than 64 bits.

>>> scene = Scene()
>>> triangle = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
>>> floats = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
>>> scene.add_instances(triangle, floats, [[0.8, 0.8, 0.8]], visibility=Visibility('unseen', hides=0))
)")
        .def(py::init([](const std::string &seen, const py::int_ &lit_by, const py::int_ &hides) {
                 return Visibility{seen_from(seen), sets_from(lit_by, "lit_by"), sets_from(hides, "hides")};
             }),
             py::arg("seen") = "shown", py::arg("lit_by") = ALL, py::arg("hides") = ALL);

    py::class_<Reach>(m, "Reach", R"(What a light reaches, and what hides it: sets, a bit each, of which an object must
have one (Visibility); without a set nothing hides it. diffuse, gloss, smoke: whether it shows in what surfaces reflect
diffusely, in their gloss, and in smoke; plate, whether it is a light of the plate, so that a catcher's shadows are
missing light of it. Raises ValueError for a light that reaches nothing, and for more than 64 bits.

>>> Scene().add_sun((0, 0, -1), (4, 4, 4), reach=Reach(lights=2, hidden_by=0, smoke=False))
)")
        .def(py::init([](const py::int_ &lights, const py::int_ &hidden_by, bool diffuse, bool gloss, bool smoke,
                         bool plate) {
                 const Reach reach{
                     sets_from(lights, "lights"), sets_from(hidden_by, "hidden_by"), diffuse, gloss, smoke, plate};
                 if (reach.lights == 0) {
                     throw py::value_error("lights is 0: the light reaches nothing, and must be left out");
                 }
                 return reach;
             }),
             py::arg("lights") = 1, py::arg("hidden_by") = 1, py::arg("diffuse") = true, py::arg("gloss") = true,
             py::arg("smoke") = true, py::arg("plate") = true);
}

} // namespace sfumato
