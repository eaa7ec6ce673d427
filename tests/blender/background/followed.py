# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tables of addon/export/known call followed: set to something else, the picture is another one. What Blender
does by itself before we see the scene, and what other files try, is listed."""

from typing import Any

import harness
import numpy as np
import pictures
from sfumato.export.known import Struct
from stage import TABLES, Stage, names_in


# What changes the picture of the stage, to what, and what has to be so before.
Try = tuple[str, str, Any, dict[str, Any]]


def each(struct: str, values: dict[str, Any], **before: Any) -> list[Try]:
    return [(struct, name, value, before) for name, value in values.items()]


TINT, FIRE = (0.2, 0.5, 0.9), str(harness.ROOT / "blend_samples" / "frames" / "fire.vdb")
MOVED, TURNED, SMALL = (0.5, 0.0, 0.0), (0.4, 0.0, 0.0), (0.5, 0.5, 0.5)
TRIES = [
    *each("RenderSettings", {"resolution_x": 12, "resolution_y": 12, "resolution_percentage": 50}),
    *each("RenderSettings", {"pixel_aspect_x": 2.0, "pixel_aspect_y": 2.0, "film_transparent": True}),
    *each("RenderSettings", {"use_border": False, "use_crop_to_border": False, "border_min_x": 0.5, "border_min_y": 0.5,
          "border_max_x": 0.5, "border_max_y": 0.5}, use_border=True, use_crop_to_border=True, border_max_x=0.9),
    *each("Camera", {"lens": 80.0, "angle": 1.5, "angle_x": 1.5, "angle_y": 1.5, "sensor_width": 20.0, "shift_x": 0.2,
          "shift_y": 0.2, "clip_start": 5.5, "clip_end": 5.5}),
    *each("Camera", {"sensor_height": 12.0}, sensor_fit="VERTICAL"),
    *each("Camera", {"sensor_fit": "VERTICAL"}, sensor_width=60.0),
    *each("Camera", {"ortho_scale": 3.0}, type="ORTHO"),
    *each("Light", {"type": "SUN", "color": TINT, "exposure": 1.0, "normalize": False}),
    *each("Light", {"use_temperature": True}, temperature=3000.0),
    *each("Light", {"temperature": 3000.0}, use_temperature=True),
    *each("CyclesLightSettings", {"is_portal": True}),
    *each("PointLight", {"energy": 100.0, "shadow_soft_size": 1.0}),
    *each("PointLight", {"use_soft_falloff": False}, shadow_soft_size=1.0),
    *each("SpotLight", {"energy": 100.0, "shadow_soft_size": 1.0, "spot_size": 0.3, "spot_blend": 0.9}),
    *each("SpotLight", {"use_soft_falloff": False}, shadow_soft_size=1.0),
    *each("SunLight", {"energy": 1.0, "angle": 1.5}),
    *each("AreaLight", {"energy": 100.0, "shape": "ELLIPSE", "size": 2.0, "size_y": 2.0, "spread": 0.5},
          shape="RECTANGLE"),
    *each("Volume", {"filepath": FIRE}),
    *each("CyclesVisibilitySettings", {"camera": False, "diffuse": False, "glossy": False, "scatter": False}),
    *each("VolumeRender", {"space": "WORLD"}),
    *each("Object", {"location": MOVED, "rotation_euler": TURNED, "scale": SMALL, "delta_location": MOVED,
          "delta_rotation_euler": TURNED, "delta_scale": SMALL, "hide_render": True}),
]  # fmt: skip
IN_TABLES = {"PointLight": "POINT", "SpotLight": "SPOT", "SunLight": "SUN", "AreaLight": "AREA"}
# What Blender has done before we see the scene, or does after.
BY_BLENDER = {
    "Scene": "background_set objects collection view_layers rigidbody_world gravity use_gravity allow_preroll "
    "use_custom_simulation_range simulation_frame_start simulation_frame_end view_settings display_settings "
    "sequencer_colorspace_settings node_tree use_nodes compositing_node_group compositor_effects sequence_editor",
    "RenderSettings": "fps fps_base frame_map_old frame_map_new use_simplify simplify_subdivision "
    "simplify_child_particles simplify_subdivision_render simplify_child_particles_render use_simplify_normals "
    "use_compositing use_sequencer",
    "ViewLayer": "layer_collection objects use use_pass_combined",
    "AreaLight": "shadow_soft_size",
    "LayerCollection": "collection children exclude hide_viewport is_visible name",
    "Object": "rotation_quaternion rotation_axis_angle rotation_mode dimensions delta_rotation_quaternion matrix_world "
    "matrix_local matrix_basis matrix_parent_inverse parent parent_type parent_vertices parent_bone "
    "parent_bone_head_tail_factor track_axis up_axis constraints pose use_parent_final_indices modifiers vertex_groups "
    "face_maps active_shape_key active_shape_key_index show_only_shape_key add_rest_position_attribute "
    "use_simulation_cache active_material_index hide_viewport show_instancer_for_render show_instancer_for_viewport "
    "instance_type use_instance_vertices_rotation use_instance_faces_scale instance_faces_scale instance_collection "
    "is_instancer is_from_instancer is_from_set field collision soft_body rigid_body rigid_body_constraint",
    "Camera": "lens_unit",
    "Volume": "packed_file",
}
# What other files of this folder try.
TRIED_IN = {
    "passes.py": "ViewLayer.use_pass_z ViewLayer.use_pass_mist ViewLayer.use_pass_position ViewLayer.use_pass_normal "
    "ViewLayer.use_pass_object_index ViewLayer.use_pass_material_index ViewLayer.use_pass_shadow World.mist_settings "
    "Object.pass_index Material.pass_index",
    "flags.py": "Object.is_holdout Object.visible_shadow Object.visible_diffuse Object.visible_glossy "
    "Object.visible_volume_scatter Object.light_linking ObjectLightLinking.receiver_collection "
    "ObjectLightLinking.blocker_collection Light.use_shadow PointLight.use_shadow SpotLight.use_shadow SunLight.use_shadow "
    "AreaLight.use_shadow CyclesLightSettings.cast_shadow ViewLayer.material_override ViewLayer.world_override "
    "ViewLayer.use_solid ViewLayer.use_volumes ViewLayer.use_sky LayerCollection.holdout LayerCollection.indirect_only",
    "transparent.py": "ViewLayer.pass_alpha_threshold",
    "hair.py": "Object.particle_systems ViewLayer.use_strand",
    "bounces.py": "CyclesRenderSettings.max_bounces CyclesRenderSettings.diffuse_bounces "
    "CyclesRenderSettings.glossy_bounces",
    "pixel_filter.py": "CyclesRenderSettings.pixel_filter_type CyclesRenderSettings.filter_width",
    "several_views.py": "RenderSettings.use_multiview RenderSettings.views RenderSettings.stereo_views "
    "RenderSettings.views_format Camera.stereo",
    "exposure.py": "RenderSettings.use_motion_blur RenderSettings.motion_blur_shutter "
    "RenderSettings.motion_blur_shutter_curve RenderSettings.motion_blur_position CyclesRenderSettings.motion_blur_position "
    "ViewLayer.use_motion_blur CyclesObjectSettings.use_motion_blur CyclesObjectSettings.use_deform_motion "
    "CyclesObjectSettings.motion_steps CameraDOFSettings.use_dof CameraDOFSettings.focus_object "
    "CameraDOFSettings.focus_subtarget CameraDOFSettings.focus_distance CameraDOFSettings.aperture_fstop "
    "CameraDOFSettings.aperture_blades CameraDOFSettings.aperture_rotation CameraDOFSettings.aperture_ratio",
    "render.py": "Scene.camera RenderSettings.threads RenderSettings.threads_mode RenderSettings.use_persistent_data",
    "smoke.py": "Scene.frame_current Scene.frame_subframe Scene.frame_float Scene.frame_current_final",
    "bad_input.py": "Object.data Object.type Object.material_slots Scene.world World.node_tree World.use_nodes World.color",
    "volume_settings.py": "Volume.is_sequence Volume.frame_start Volume.frame_duration Volume.frame_offset "
    "Volume.sequence_mode Volume.grids Volume.materials Object.active_material",
    "lamp_settings.py": "Light.node_tree Light.use_nodes Light.temperature_color",
    "materials.py": "Material.node_tree Material.use_nodes Material.diffuse_color",
}


def test_every_followed_property_is_tried_or_blenders() -> None:
    followed = {f"{table.name}.{name}" for table in TABLES.values() for name in names_in(table.followed)}
    tried = {f"{struct}.{name}" for struct, name, _, _ in TRIES}
    tried |= {f"{struct}.{name}" for struct, names in BY_BLENDER.items() for name in names.split()}
    tried |= {name for names in TRIED_IN.values() for name in names.split()}
    assert followed == tried, sorted(followed ^ tried)
    here = harness.ROOT / "tests" / "blender" / "background"
    assert all((here / name).exists() for name in TRIED_IN)


def test_what_is_followed_changes_the_picture() -> None:
    wrong: list[str] = []
    stages: dict[str, Stage] = {}
    kind = ""
    for struct, name, value, before in sorted(TRIES, key=lambda entry: IN_TABLES.get(entry[0], "POINT")):
        if kind != IN_TABLES.get(struct, "POINT"):
            kind = IN_TABLES.get(struct, "POINT")
            stages[kind] = Stage(kind)
        owner = owner_of(stages[kind], TABLES[struct])
        if not hasattr(owner, name):
            continue
        kept = {key: copied(getattr(owner, key)) for key in (name, *before)}
        set_all(owner, before)
        first = pictures.render()
        setattr(owner, name, value)
        second = pictures.render()
        if first.shape == second.shape and np.abs(first - second).max() < 1e-4:
            wrong.append(f"{struct}.{name} = {value}")
        set_all(owner, kept)
    assert not wrong, "\n".join(wrong)


def owner_of(stage: Stage, table: Struct) -> Any:
    owner, _ = next(stage.owners(table.root, ("VOLUME",)))
    for part in table.at.split(".") if table.at else ():
        owner = getattr(owner, part)
    return owner


def copied(value: Any) -> Any:
    return tuple(value) if hasattr(value, "__len__") and not isinstance(value, str) else value


def set_all(owner: Any, values: dict[str, Any]) -> None:
    for name, value in values.items():
        setattr(owner, name, value)


harness.main()
