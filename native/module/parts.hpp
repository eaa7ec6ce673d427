// SPDX-License-Identifier: GPL-3.0-or-later
// The module's other files, each a subject.
#pragma once

#include <pybind11/pybind11.h>

namespace sfumato {

void bind_airlight(pybind11::module_ &m);
void bind_area_light(pybind11::module_ &m);
void bind_basis(pybind11::module_ &m);
void bind_exposure(pybind11::module_ &m);
void bind_frame(pybind11::module_ &m);
void bind_frame_parts(pybind11::module_ &m);
void bind_map(pybind11::module_ &m);
void bind_measure(pybind11::module_ &m);
void bind_microfacet(pybind11::module_ &m);
void bind_opacity(pybind11::module_ &m);
void bind_pattern(pybind11::module_ &m);
void bind_pictures(pybind11::module_ &m);
void bind_ray_storage(pybind11::module_ &m);
void bind_reference(pybind11::module_ &m);
void bind_reference_airlight(pybind11::module_ &reference);
void bind_reference_area_light(pybind11::module_ &reference);
void bind_scene(pybind11::module_ &m);
void bind_scene_parts(pybind11::module_ &m);
void bind_shafts(pybind11::module_ &m);
void bind_sky(pybind11::module_ &m);
void bind_textures(pybind11::module_ &m);
void bind_transfer(pybind11::module_ &m);
void bind_transparency(pybind11::module_ &m);
void bind_visibility(pybind11::module_ &m);
void bind_reference_microfacet(pybind11::module_ &reference);
void bind_reference_transfer(pybind11::module_ &reference);

void refuse_plainly(pybind11::module_ &m); // the functions that are there by then

} // namespace sfumato
