# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects, and what they are of: lamps, cameras, volumes, meshes, curves; and worlds and materials without their nodes."""

from __future__ import annotations

from . import Named, Struct

SURFACES = ("MESH", "CURVE", "SURFACE", "FONT", "META")
# Objects that Cycles renders and we do not, by their types, and what is said of them.
_GREASE_PENCIL = "Grease Pencil is laid over the picture by Blender, whatever is before it"
UNSHOWN = {
    "GPENCIL": _GREASE_PENCIL,
    "GREASEPENCIL": _GREASE_PENCIL,
}
# What is said of particles, which may be the points of a cloud.
POINTS = {
    "misplaced": "{value} of {all} particles have no finite place; left out",
    "unsized": "{value} of {all} particles have no size of 0 or more; left out",
    "dead": "no particle of '{value}' is alive at frame {frame}",
    "children": "its particle system '{value}' has children, which are not shown; their parents are",
    "liquid": "its particle system '{value}', the liquid's own, is not shown; its mesh is",
    "opacity": "the opacity {value} of '{settings}' is taken for {shown}",
    "alike": "its particles have no attribute '{value}'; they are all alike",
    "dark": "its puffs do not glow",
    "round": "its puffs are round in spite of its uneven scale, and as large as it makes them",
    "flat": "its scale {value} leaves the particles of its instances no place",
    "soft": "its points, which are seen through, are shown as soft puffs, not as spheres",
    "many": "its {value} points are shown as soft puffs; up to {most} would be spheres",
    "glow": "its points glow, but light nothing",
    "uneven": "its uneven scale makes true ellipsoids of its points, unlike in Cycles",
}

_INTERFACE = "Blender's interface"
_VIEWPORT = "how Blender's own viewport draws it"
_EEVEE = "EEVEE alone reads it"
_SAMPLING = "how fast Cycles' noise goes; our pictures have none"
_INDIRECT = "light that surfaces pass on, of which we show none"
_MOTION = "how smoke moves, of which Motion Blur makes nothing but a notice"
_CAUSTICS = "light through glass, which materials name"
_PANORAMA = "details of panoramic cameras, which are named as a whole"
_TEXTURES = "textures, of which we show none"
_MODELLING = "tools of modelling and painting"
_WORLD = "light of the world, which is named as a whole"

OBJECT = Struct(
    "Object",
    "object",
    followed={
        "where it is: place, rotation, scale, parents, constraints": "location rotation_quaternion rotation_axis_angle "
        "rotation_euler rotation_mode scale dimensions delta_location delta_rotation_euler delta_rotation_quaternion "
        "delta_scale matrix_world matrix_local matrix_basis matrix_parent_inverse parent parent_type parent_vertices "
        "parent_bone parent_bone_head_tail_factor track_axis up_axis constraints pose use_parent_final_indices",
        "its data, modifiers and shape keys": "data type modifiers vertex_groups face_maps active_shape_key "
        "active_shape_key_index show_only_shape_key add_rest_position_attribute use_simulation_cache",
        "materials": "material_slots active_material active_material_index",
        "the pass Object Index": "pass_index",
        "holdouts, what casts shadows, what catches them, and what the camera sees": "is_holdout visible_shadow",
        "what a light shows in: diffuse surfaces, glossy ones, smoke": "visible_diffuse visible_glossy "
        "visible_volume_scatter",
        "light linking": "light_linking",
        "whether it is hidden": "hide_render hide_viewport show_instancer_for_render show_instancer_for_viewport",
        "hair of its particle systems": "particle_systems",
        "instances": "instance_type use_instance_vertices_rotation use_instance_faces_scale instance_faces_scale "
        "instance_collection is_instancer is_from_instancer is_from_set",
        "physics, by Blender": "field collision soft_body rigid_body rigid_body_constraint",
        "particles that render as Halo, of which Cycles draws none, as soft puffs: by a volume or a surface that is seen "
        "through, of the system's material, else by its panel Sfumato": "",
        "particles that render as Object or Collection": "",
        "point clouds: spheres, or by a volume, which Cycles ignores, soft puffs": "",
    },
    named=(
        Named("is_shadow_catcher", (False,), "smoke catches no shadow; it is shown as smoke", kinds=("VOLUME",),
              elsewhere=True),
        Named("visible_camera", (False,), "its Camera visibility is on, but the lamp itself is not seen",
              kinds=("LIGHT",)),
        Named("shadow_terminator_shading_offset", (0.0,), "its Shadow Terminator's Shading Offset of {value} is not "
              "followed; there is none", kinds=("GLOWING", "DARK")),
    ),
    idle={
        "light that passes through it, of which we show none": "visible_transmission",
        "Raycast nodes, which materials name": "visible_raycast",
        "the Object Info node, which materials name": "color",
        "light groups, which the view layer names": "lightgroup",
        "how Cycles hides its own artefacts at the edge of shadows": "shadow_terminator_geometry_offset "
        "shadow_terminator_normal_offset",
        "grease pencil, which Blender draws": "grease_pencil_modifiers shader_effects use_grease_pencil_lights",
        "empties, which no render shows": "empty_display_type empty_display_size empty_image_offset empty_image_depth "
        "empty_image_side show_empty_image_perspective show_empty_image_orthographic "
        "show_empty_image_only_axis_aligned use_empty_image_alpha image_user",
        _EEVEE: "hide_probe_volume hide_probe_sphere hide_probe_plane",
        _VIEWPORT: "display display_type display_bounds_type show_bounds show_name show_axis show_texture_space show_wire "
        "show_all_edges show_transparent show_in_front bound_box",
        _INTERFACE: "mode lock_location lock_rotation lock_rotation_w lock_rotations_4d lock_scale hide_select "
        "hide_surface_pick use_camera_lock_parent use_shape_key_edit_mode lineart pose_library animation_visualization "
        "motion_path selection_sets active_selection_set",
        _MODELLING: "use_dynamic_topology_sculpting use_mesh_mirror_x use_mesh_mirror_y use_mesh_mirror_z",
    },
)  # fmt: skip

CYCLES_OBJECT = Struct(
    "CyclesObjectSettings",
    "object",
    "cycles",
    followed={"motion blur, of meshes' shapes too": "use_motion_blur use_deform_motion motion_steps"},
    named=(
        Named("use_adaptive_subdivision", (False,), "its Adaptive Subdivision is not followed; it is subdivided as in "
              "other engines", kinds=SURFACES, elsewhere=True),
        Named("shadow_terminator_offset", (0.0,), "its Shadow Terminator's Shading Offset of {value} is not followed; "
              "there is none", kinds=("GLOWING", "DARK")),
    ),
    idle={
        "culling, which the scene names": "use_camera_cull use_distance_cull",
        "details of adaptive subdivision, which is named as a whole": "dicing_rate",
        "how Cycles hides its own artefacts at the edge of shadows": "shadow_terminator_geometry_offset",
        _INDIRECT: "ao_distance",
        _CAUSTICS: "is_caustics_caster is_caustics_receiver",
    },
)  # fmt: skip

LIGHT_LINKING = Struct(
    "ObjectLightLinking",
    "object",
    "light_linking",
    followed={"light and shadow linking": "receiver_collection blocker_collection"},
)  # fmt: skip

_LAMPS_OF_EEVEE = (
    "shadow_buffer_bias shadow_buffer_clip_start shadow_buffer_samples shadow_buffer_size shadow_color "
    "shadow_filter_radius shadow_maximum_resolution shadow_jitter_overblur use_shadow_jitter use_absolute_resolution "
    "use_contact_shadow contact_shadow_bias contact_shadow_distance contact_shadow_thickness"
)
_SHADOW = {"whether it casts shadows": "use_shadow"}
_FALLOFF = {
    "falloffs that no engine has read since 2.8": "falloff_type falloff_curve linear_attenuation quadratic_attenuation "
    "constant_coefficient linear_coefficient quadratic_coefficient"
}

LIGHT = Struct(
    "Light",
    "light",
    followed={
        **_SHADOW,
        "its kind": "type",
        "color, exposure and temperature": "color exposure use_temperature temperature temperature_color",
        "whether its power is normalized by its size": "normalize",
        "nodes: an Emission of a constant color and strength": "node_tree use_nodes",
    },
    idle={
        _EEVEE: "distance specular_factor diffuse_factor volume_factor transmission_factor use_custom_distance "
        "cutoff_distance",
    },
)
CYCLES_LIGHT = Struct(
    "CyclesLightSettings",
    "light",
    "cycles",
    followed={
        "portals, which give no light themselves": "is_portal",
        "whether it casts shadows, before 4.2": "cast_shadow",
    },
    idle={
        _SAMPLING: "use_multiple_importance_sampling",
        _INDIRECT: "max_bounces",
        _CAUSTICS: "is_caustics_light",
    },
)
POINT = Struct(
    "PointLight",
    "light",
    followed={**_SHADOW, "power, radius and soft falloff": "energy shadow_soft_size use_soft_falloff"},
    idle={_EEVEE: _LAMPS_OF_EEVEE, **_FALLOFF},
)
SPOT = Struct(
    "SpotLight",
    "light",
    followed={
        **_SHADOW,
        "power, radius and soft falloff": "energy shadow_soft_size use_soft_falloff",
        "the cone's size and blend": "spot_size spot_blend",
    },
    idle={_EEVEE: _LAMPS_OF_EEVEE + " use_square", _VIEWPORT: "show_cone", **_FALLOFF},
)
SUN = Struct(
    "SunLight",
    "light",
    followed={**_SHADOW, "strength and angle": "energy angle"},
    idle={
        _EEVEE: _LAMPS_OF_EEVEE + " shadow_soft_size shadow_cascade_count shadow_cascade_exponent shadow_cascade_fade "
        "shadow_cascade_max_distance",
    },
)
AREA = Struct(
    "AreaLight",
    "light",
    followed={
        **_SHADOW,
        "power, shape, size and spread": "energy shape size size_y spread",
        "its size by another name, before 4.0": "shadow_soft_size",
    },
    idle={_EEVEE: _LAMPS_OF_EEVEE, **_FALLOFF},
)

_PANORAMIC = (
    "panorama_type fisheye_fov fisheye_lens fisheye_polynomial_k0 fisheye_polynomial_k1 fisheye_polynomial_k2 "
    "fisheye_polynomial_k3 fisheye_polynomial_k4 latitude_min latitude_max longitude_min longitude_max "
)
CAMERA = Struct(
    "Camera",
    "camera",
    followed={
        "lens, sensor and shift": "lens lens_unit angle angle_x angle_y sensor_fit sensor_width sensor_height shift_x "
        "shift_y",
        "orthographic scale": "ortho_scale",
        "clipping": "clip_start clip_end",
        "stereoscopy": "stereo",
    },
    named=(
        Named("type", ("PERSP", "ORTHO"), "a camera of type {value} is not shown; the picture is that of a "
              "perspective one"),
    ),
    idle={
        _PANORAMA: _PANORAMIC + "central_cylindrical_range_u_min central_cylindrical_range_u_max "
        "central_cylindrical_range_v_min central_cylindrical_range_v_max central_cylindrical_radius custom_filepath "
        "custom_shader custom_mode custom_bytecode custom_bytecode_hash cycles_custom",
        _VIEWPORT: "passepartout_alpha display_size show_limits show_mist show_passepartout show_safe_areas "
        "show_safe_center show_name show_sensor show_background_images background_images show_composition_center "
        "show_composition_center_diagonal show_composition_golden show_composition_golden_tria_a "
        "show_composition_golden_tria_b show_composition_harmony_tri_a show_composition_harmony_tri_b "
        "show_composition_thirds composition_guide_color",
    },
)  # fmt: skip
CYCLES_CAMERA = Struct("CyclesCameraSettings", "camera", "cycles", idle={_PANORAMA: _PANORAMIC.strip()})
CYCLES_CUSTOM_CAMERA = Struct("CyclesCustomCameraSettings", "camera", "cycles_custom")
DEPTH_OF_FIELD = Struct(
    "CameraDOFSettings",
    "camera",
    "dof",
    followed={
        "depth of field, at rest and in renders": "use_dof focus_object focus_subtarget focus_distance aperture_fstop "
        "aperture_blades aperture_rotation aperture_ratio",
    },
)

WORLD = Struct(
    "World",
    "world",
    followed={
        "Backgrounds, their sums and mixtures, of colors, environment textures, sky textures and gradients: as a backdrop, "
        "and the light that they give": "node_tree use_nodes color",
        "a volume that is the same everywhere: any volume shaders, their sums and mixtures; "
        "of suns, which Cycles blacks out in it, the light as it would be without": "",
        "the pass Mist": "mist_settings",
    },
    idle={
        _INDIRECT: "light_settings",
        "light groups, which the view layer names": "lightgroup",
        _EEVEE: "use_eevee_finite_volume probe_resolution sun_threshold sun_angle use_sun_shadow "
        "sun_shadow_maximum_resolution sun_shadow_filter_radius use_sun_shadow_jitter sun_shadow_jitter_overblur",
    },
)
CYCLES_WORLD = Struct(
    "CyclesWorldSettings",
    "world",
    "cycles",
    idle={
        _SAMPLING: "sampling_method sample_map_resolution",
        _WORLD: "max_bounces is_caustics_light use_shadows",
        "how Cycles samples the world's volume": "homogeneous_volume volume_sampling volume_interpolation "
        "volume_step_size",
    },
)
WORLD_VISIBILITY = Struct(
    "CyclesVisibilitySettings",
    "world",
    "cycles_visibility",
    followed={"to what a world shows": "camera diffuse glossy scatter"},
    idle={_WORLD: "transmission shadow"},
)

VOLUME = Struct(
    "Volume",
    "volume",
    followed={
        "its file": "filepath packed_file",
        "a sequence, its frames and its mode": "is_sequence frame_start frame_duration frame_offset sequence_mode",
        "the grid that its material asks for": "grids",
        "its material": "materials",
    },
    idle={
        _MOTION: "velocity_grid velocity_unit velocity_scale velocity_x_grid velocity_y_grid velocity_z_grid",
        _VIEWPORT: "display",
    },
)
VOLUME_RENDER = Struct(
    "VolumeRender",
    "volume",
    "render",
    followed={"whether its density is of its own or of the world's space": "space"},
    named=(Named("clipping", (), "its Clipping of {value} is not followed; all voxels are shown", elsewhere=True),),
    idle={
        "how exactly Cycles marches smoke; ours is the scene's Quality": "step_size",
        "how Cycles rounds voxels; we keep what the file has": "precision",
    },
)
VOLUME_DISPLAY = Struct(
    "VolumeDisplay",
    "volume",
    "display",
    idle={
        _VIEWPORT: "density wireframe_type wireframe_detail interpolation_method use_slice slice_axis slice_depth",
    },
)

_TRANSPARENT_SHADOW = Named(
    "use_transparent_shadow", (True,), "its Transparent Shadows, which are off, are shown as on", elsewhere=True
)
MATERIAL = Struct(
    "Material",
    "material",
    named=(_TRANSPARENT_SHADOW,),
    followed={
        "nodes, and the viewport color where there are none": "node_tree use_nodes diffuse_color",
        "the pass Material Index": "pass_index",
    },
    idle={
        "displacement, which nodes name": "displacement_method max_vertex_displacement",
        _EEVEE: "blend_method shadow_method surface_render_method alpha_threshold show_transparent_back "
        "use_transparency_overlap use_backface_culling use_backface_culling_shadow "
        "use_backface_culling_lightprobe_volume use_screen_refraction use_raytrace_refraction use_sss_translucency "
        "refraction_depth thickness_mode use_thickness_from_shadow volume_intersection_method",
        _VIEWPORT: "roughness metallic specular_color specular_intensity preview_render_type use_preview_world",
        "grease pencil and line art": "grease_pencil is_grease_pencil lineart line_color line_priority",
        _MODELLING: "texture_paint_images texture_paint_slots paint_active_slot paint_clone_slot",
    },
)
CYCLES_MATERIAL = Struct(
    "CyclesMaterialSettings",
    "material",
    "cycles",
    named=(
        Named("volume_interpolation", ("LINEAR",), "its Volume Interpolation {value} is not followed; it is Linear",
              kinds=("SMOKE",)),
        Named("homogeneous_volume", (False,), "its Homogeneous is not followed; its smoke is as dense as its voxels say",
              kinds=("SMOKE",)),
        _TRANSPARENT_SHADOW,
    ),
    idle={
        _SAMPLING: "sample_as_light emission_sampling volume_sampling",
        "how exactly Cycles marches smoke; ours is the scene's Quality": "volume_step_rate",
        "displacement, which nodes name": "displacement_method",
        "bump, which nodes name": "use_bump_map_correction",
    },
)  # fmt: skip

CYCLES_MESH = Struct("CyclesMeshSettings", "mesh", "cycles")

STRUCTS = (
    OBJECT,
    CYCLES_OBJECT,
    LIGHT_LINKING,
    LIGHT,
    CYCLES_LIGHT,
    POINT,
    SPOT,
    SUN,
    AREA,
    CAMERA,
    CYCLES_CAMERA,
    CYCLES_CUSTOM_CAMERA,
    DEPTH_OF_FIELD,
    WORLD,
    CYCLES_WORLD,
    WORLD_VISIBILITY,
    VOLUME,
    VOLUME_RENDER,
    VOLUME_DISPLAY,
    MATERIAL,
    CYCLES_MATERIAL,
    CYCLES_MESH,
)
