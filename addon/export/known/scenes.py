# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes, their render settings, and view layers."""

from __future__ import annotations

from . import RENDER, Named, Struct

_INDIRECT = "light that glass or smoke pass on, of which we show none"
_SAMPLING = "how fast and how evenly Cycles' noise goes; our pictures have none"
_FILES = "how Blender writes the file, after our picture is done"
_STAMP = "what Blender writes into the file or onto the picture"
_BAKE = "baking"
_SPEED = "speed and memory of Cycles"
_INTERFACE = "Blender's interface"
_EEVEE = "EEVEE alone reads it"
_FREESTYLE = "Freestyle's lines, which Blender draws over the picture"
_COMPOSITOR = "Blender's compositor, which has our picture as any other"
_SOUND = "sound"

SCENE = Struct(
    "Scene",
    "scene",
    followed={
        "the camera": "camera",
        "the world": "world",
        "a background set": "background_set",
        "the frame": "frame_current frame_subframe frame_float frame_current_final",
        "objects, collections and view layers": "objects collection view_layers",
        "what modifiers, physics and caches make at this frame": "rigidbody_world gravity use_gravity allow_preroll "
        "use_custom_simulation_range simulation_frame_start simulation_frame_end",
        "color management, by Blender": "view_settings display_settings sequencer_colorspace_settings",
        "compositing and the sequencer, by Blender": "node_tree use_nodes compositing_node_group compositor_effects "
        "sequence_editor",
    },
    idle={
        "frame ranges; each frame is rendered as it is": "frame_start frame_end frame_step",
        _EEVEE: "eevee",
        "Workbench and Hydra alone read them": "display hydra",
        _SOUND: "use_audio use_audio_scrub audio_doppler_speed audio_doppler_factor audio_distance_model audio_volume",
        _INTERFACE: "lock_frame_selection_to_range use_preview_range frame_preview_start frame_preview_end show_subframe "
        "show_keys_from_selected_only is_nla_tweakmode sync_mode keying_sets keying_sets_all tool_settings "
        "unit_settings safe_areas timeline_markers transform_orientation_slots cursor time_jump_unit time_jump_delta "
        "wrap_timeline_navigation playback_loop_mode active_clip annotation grease_pencil grease_pencil_settings",
        _STAMP: "use_stamp_note",
    },
)  # fmt: skip

RENDER_SETTINGS = Struct(
    "RenderSettings",
    "scene",
    "render",
    followed={
        "resolution and pixel aspect": "resolution_x resolution_y resolution_percentage pixel_aspect_x pixel_aspect_y",
        "the render region": "use_border border_min_x border_min_y border_max_x border_max_y use_crop_to_border",
        "a transparent film": "film_transparent",
        "the frame rate and time stretching": "fps fps_base frame_map_old frame_map_new",
        "Simplify's subdivision and particles, by Blender": "use_simplify simplify_subdivision "
        "simplify_child_particles simplify_subdivision_render simplify_child_particles_render use_simplify_normals",
        "stereoscopy and views": "use_multiview views stereo_views views_format",
        "threads": "threads threads_mode",
        "persistent data": "use_persistent_data",
        "compositing and the sequencer, by Blender": "use_compositing use_sequencer",
        "motion blur of the camera and of what surfaces have; what smoke, hair and particles do is named": "use_motion_blur "
        "motion_blur_shutter motion_blur_shutter_curve motion_blur_position",
    },
    named=(
        Named("simplify_volumes", (1.0,), "Simplify's Volume Resolution of {value} is not followed; volumes have all "
              "of their voxels", when=(("render.use_simplify", True),)),
    ),
    idle={
        _FILES: "image_settings ffmpeg dither_intensity use_placeholder use_overwrite use_file_extension "
        "file_extension is_movie_format filepath save_output ppm_factor ppm_base",
        _STAMP: "use_stamp use_stamp_camera use_stamp_date use_stamp_filename use_stamp_frame use_stamp_frame_range "
        "use_stamp_hostname use_stamp_labels use_stamp_lens use_stamp_marker use_stamp_memory use_stamp_note "
        "use_stamp_render_time use_stamp_scene use_stamp_sequencer_strip use_stamp_time stamp_background "
        "stamp_font_size stamp_foreground stamp_note_text metadata_input",
        _BAKE: "bake bake_bias bake_margin bake_margin_type bake_samples bake_type bake_user_scale use_bake_clear "
        "use_bake_lores_mesh use_bake_multires use_bake_selected_to_active use_bake_user_scale",
        _EEVEE: "filter_size hair_type hair_subdiv use_high_quality_normals anisotropic_filter",
        "panoramic cameras, which are named": "use_spherical_stereo",
        _FREESTYLE: "use_freestyle line_thickness line_thickness_mode",
        "grease pencil, which Blender draws": "simplify_gpencil simplify_gpencil_antialiasing simplify_gpencil_modifier "
        "simplify_gpencil_onplay simplify_gpencil_shader_fx simplify_gpencil_tint simplify_gpencil_view_fill",
        _COMPOSITOR: "compositor_device compositor_precision compositor_denoise_device "
        "compositor_denoise_final_quality compositor_denoise_preview_quality use_render_cache "
        "use_compositor_frames_cache",
        _INTERFACE: "use_lock_interface sequencer_gl_preview use_sequencer_override_scene_strip has_multiple_engines "
        "use_single_layer engine",
        "how coarse a view may be while it is computed": "preview_pixel_size",
        "textures, of which we show none": "use_texture_cache use_auto_generate_texture_cache",
    },
)  # fmt: skip

CYCLES = Struct(
    "CyclesRenderSettings",
    "scene",
    "cycles",
    followed={
        "the pixel filter and its width": "pixel_filter_type filter_width",
        "how often light goes between surfaces: gloss shows the others once or not at all, and with Bounced Light what is "
        "matt is lit by them": "max_bounces diffuse_bounces glossy_bounces",
        "when the shutter opens": "motion_blur_position",
    },
    named=(
        Named("rolling_shutter_type", ("NONE",), "the Rolling Shutter is not followed; all of the picture is taken at once",
              when=(("render.use_motion_blur", True),), only=RENDER),
        Named("film_exposure", (1.0,), "Film's Exposure of {value} is not followed; it is taken for 1"),
        Named("sample_clamp_direct", (0.0,), "Clamping of Direct Light at {value} is not followed; nothing is clamped"),
        Named("caustics_refractive", (True,), "its glass casts a shadow in its color, though Refractive Caustics is off",
              elsewhere=True),
        Named("blur_glossy", (0.0,), "its glass takes no light for Filter Glossy, by which Cycles' shadow of it is darker",
              elsewhere=True),
        Named("film_transparent_glass", (True,), "the transparent film is seen through its glass, though Transparent "
              "Glass is off", when=(("render.film_transparent", True),), elsewhere=True),
        Named("use_camera_cull", (False,), "Simplify's Camera Culling is not followed; nothing is left out",
              when=(("render.use_simplify", True),)),
        Named("use_distance_cull", (False,), "Simplify's Distance Culling is not followed; nothing is left out",
              when=(("render.use_simplify", True),)),
    ),
    idle={
        _INDIRECT: "transmission_bounces volume_bounces min_light_bounces "
        "caustics_reflective sample_clamp_indirect use_fast_gi fast_gi_method "
        "ao_bounces ao_bounces_render",
        "how many transparent surfaces Cycles looks through; we do through all": "transparent_max_bounces "
        "min_transparent_bounces",
        "how clear glass is to Cycles' film; ours is always clear": "film_transparent_roughness",
        _SAMPLING: "samples preview_samples sample_offset use_sample_subset sample_subset_length time_limit "
        "sampling_pattern scrambling_distance preview_scrambling_distance auto_scrambling_distance use_layer_samples "
        "light_sampling_threshold use_adaptive_sampling adaptive_threshold adaptive_min_samples "
        "use_preview_adaptive_sampling preview_adaptive_threshold preview_adaptive_min_samples "
        "direct_light_sampling_type use_light_tree seed use_animated_seed use_pixel_jitter",
        "Cycles' guided paths": "use_guiding use_deterministic_guiding guiding_distribution_type use_surface_guiding "
        "surface_guiding_probability use_volume_guiding guiding_training_samples volume_guiding_probability "
        "use_guiding_direct_light use_guiding_mis_weights guiding_directional_sampling_type guiding_roughness_threshold",
        "Cycles' denoisers": "use_denoising denoiser denoising_prefilter denoising_quality denoising_input_passes "
        "denoising_use_gpu use_preview_denoising preview_denoiser preview_denoising_prefilter "
        "preview_denoising_quality preview_denoising_input_passes preview_denoising_start_sample "
        "preview_denoising_use_gpu preview_denoising_upscale_quality",
        "how exactly Cycles marches smoke; ours is the scene's Quality": "volume_step_rate volume_preview_step_rate "
        "volume_max_steps volume_biased",
        "adaptive subdivision, which objects name": "dicing_rate preview_dicing_rate max_subdivisions dicing_camera "
        "offscreen_dicing_scale",
        "details of culling, which is named as a whole": "camera_cull_margin distance_cull_margin",
        "details of the rolling shutter, which is named": "rolling_shutter_duration",
        "textures, of which we show none": "texture_limit texture_limit_render texture_resolution "
        "texture_resolution_render",
        _BAKE: "bake_type",
        _SPEED: "device feature_set shading_system preview_pause use_auto_tile tile_size debug_bvh_layout "
        "debug_bvh_time_steps debug_bvh_type debug_use_compact_bvh debug_use_hair_bvh debug_use_spatial_splits "
        "debug_use_cpu_avx debug_use_cpu_avx2 debug_use_cpu_sse2 debug_use_cpu_sse3 debug_use_cpu_sse41 "
        "debug_use_cpu_sse42 debug_use_cuda_adaptive_compile debug_use_hip_adaptive_compile "
        "debug_use_metal_adaptive_compile debug_use_optix_debug debug_use_texture_cache_eviction "
        "debug_texture_cache_preserve_unused",
    },
)  # fmt: skip

CYCLES_CURVES = Struct(
    "CyclesCurveRenderSettings",
    "scene",
    "cycles_curves",
    idle={
        "how finely Cycles cuts hair, and whether it is flat: ours is round, and as smooth as the picture": "shape "
        "subdivisions"
    },
)

_PASSES = {
    "use_pass_vector": "Vector",
    "use_pass_uv": "UV",
    "use_pass_ambient_occlusion": "Ambient Occlusion",
    "use_pass_emit": "Emission",
    "use_pass_environment": "Environment",
    "use_pass_diffuse_direct": "Diffuse Direct",
    "use_pass_diffuse_indirect": "Diffuse Indirect",
    "use_pass_diffuse_color": "Diffuse Color",
    "use_pass_glossy_direct": "Glossy Direct",
    "use_pass_glossy_indirect": "Glossy Indirect",
    "use_pass_glossy_color": "Glossy Color",
    "use_pass_transmission_direct": "Transmission Direct",
    "use_pass_transmission_indirect": "Transmission Indirect",
    "use_pass_transmission_color": "Transmission Color",
    "use_pass_subsurface_direct": "Subsurface Direct",
    "use_pass_subsurface_indirect": "Subsurface Indirect",
    "use_pass_subsurface_color": "Subsurface Color",
    "use_pass_cryptomatte_object": "Cryptomatte Object",
    "use_pass_cryptomatte_material": "Cryptomatte Material",
    "use_pass_cryptomatte_asset": "Cryptomatte Asset",
}
_CYCLES_PASSES = {
    "use_pass_volume_direct": "Volume Direct",
    "use_pass_volume_indirect": "Volume Indirect",
    "use_pass_shadow_catcher": "Shadow Catcher",
    "use_pass_volume_scatter": "Volume Scatter",
    "use_pass_volume_transmit": "Volume Transmit",
    "use_pass_volume_majorant": "Volume Majorant",
    "denoising_store_passes": "Denoising Data",
    "denoising_store_motion_passes": "Denoising Motion",
    "pass_debug_sample_count": "Sample Count",
    "pass_render_time": "Render Time",
}


def _passes(labels: dict[str, str]) -> tuple[Named, ...]:
    return tuple(
        Named(
            name, (False,), f"these passes are not made, and stay out of the file: {label}", only=RENDER, elsewhere=True
        )
        for name, label in labels.items()
    )


VIEW_LAYER = Struct(
    "ViewLayer",
    "layer",
    followed={
        "which collections and objects are in it": "layer_collection objects use",
        "what is overridden in it": "material_override world_override",
        "Surfaces, Volumes and Environment": "use_solid use_volumes use_sky",
        "the passes Combined, Depth, Mist, Position, Normal, Object and Material Index, and Shadow": "use_pass_combined "
        "use_pass_z use_pass_mist use_pass_position use_pass_normal use_pass_object_index use_pass_material_index "
        "use_pass_shadow",
        "the alpha from which on passes tell of a surface": "pass_alpha_threshold",
        "hair": "use_strand",
        "motion blur": "use_motion_blur",
    },
    named=(
        Named("aovs", (0,), "these passes are not made, and stay out of the file: the AOV '…'", only=RENDER,
              elsewhere=True),
        Named("lightgroups", (0,), "these passes are not made, and stay out of the file: the light group '…'",
              only=RENDER, elsewhere=True),
        *_passes(_PASSES),
    ),
    idle={
        _SAMPLING: "samples",
        _EEVEE: "eevee use_ao",
        _FREESTYLE: "use_freestyle freestyle_settings",
        "details of passes, which are named": "pass_cryptomatte_depth use_pass_cryptomatte_accurate",
        "grease pencil, which Blender draws": "use_grease_pencil use_pass_grease_pencil",
        _INTERFACE: "active_aov active_aov_index active_lightgroup active_lightgroup_index active_layer_collection "
        "has_export_collections depsgraph",
    },
)  # fmt: skip

CYCLES_LAYER = Struct(
    "CyclesRenderLayerSettings",
    "layer",
    "cycles",
    named=_passes(_CYCLES_PASSES),
    idle={
        "Cycles' denoisers": "use_denoising denoising_pass_follow_reflections "
        "denoising_pass_use_albedo_roughness_weighting",
    },
)

LAYER_COLLECTION = Struct(
    "LayerCollection",
    "layer_collection",
    followed={
        "collections that are excluded or hidden": "collection children exclude hide_viewport is_visible name",
        "Holdout and Indirect Only": "holdout indirect_only",
    },
)

STRUCTS = (SCENE, RENDER_SETTINGS, CYCLES, CYCLES_CURVES, VIEW_LAYER, CYCLES_LAYER, LAYER_COLLECTION)
