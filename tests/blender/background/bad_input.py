# SPDX-License-Identifier: GPL-3.0-or-later
"""What is wrong in a scene is said, names the thing, and costs nothing but itself."""

import os
import shutil
import subprocess
import tempfile
from pathlib import Path

import bpy
import harness
import numpy as np
import pictures
from sfumato import core, log  # type: ignore[attr-defined]
from sfumato.export import voxels

TINY = (32, 18)


def said(*words: str) -> bool:
    """Whether one notice holds all of the words."""
    return any(all(word in notice for word in words) for notice in log.notices())


def domain() -> bpy.types.Object:
    if harness.MANTAFLOW_ABORTS:
        raise harness.Skip("Mantaflow domains cannot be used in this Blender")
    return harness.open_plume()


def assert_an_error(*words: str) -> None:
    """That a render in batch stops with these words. The next one does not: the artist's own choice."""
    try:
        pictures.render(TINY)
    except RuntimeError as error:
        assert all(word in str(error) for word in words), error
    else:
        raise AssertionError("a picture without its smoke is no error")
    bpy.context.scene.sfumato.missing_is_error = False


def test_missing_cache() -> None:
    thing = domain()
    thing.modifiers["Fluid"].domain_settings.cache_directory = "//nowhere"
    bpy.context.scene.frame_set(24)
    assert_an_error("frame 24", "nowhere")
    assert np.isfinite(pictures.render(TINY)).all()
    assert said(thing.name, "frame 24", "nowhere"), log.notices()
    thing.modifiers["Fluid"].domain_settings.cache_frame_start = 30
    bpy.context.scene.sfumato.missing_is_error = True
    pictures.render(TINY)  # before its first frame a domain need have no cache


def test_domain_that_was_never_baked() -> None:
    if harness.MANTAFLOW_ABORTS:
        raise harness.Skip("Mantaflow domains cannot be used in this Blender")
    bpy.ops.mesh.primitive_cube_add()
    thing = bpy.context.object
    modifier = thing.modifiers.new("Fluid", "FLUID")
    modifier.fluid_type = "DOMAIN"
    modifier.domain_settings.domain_type = "GAS"
    modifier.domain_settings.cache_type = "ALL"
    assert_an_error(thing.name, "bake")
    pictures.render(TINY)
    assert said(thing.name, "bake"), log.notices()


def test_density_that_is_not_a_number() -> None:
    thing = domain()
    real = voxels.domain_grid

    def broken(*arguments: object) -> object:
        density, matrix = real(*arguments)
        density[3, 3, 3] = np.nan
        return density, matrix

    voxels.domain_grid = broken
    try:
        assert np.isfinite(pictures.render(TINY)).all()
    finally:
        voxels.domain_grid = real
    assert said(thing.name, "not finite"), log.notices()


def test_domain_without_size() -> None:
    thing = harness.open_plume()
    thing.scale = (0.0, 1.0, 1.0)
    assert np.isfinite(pictures.render(TINY)).all()
    assert said(thing.name, "scale"), log.notices()


def test_flattened_domain_costs_what_it_costs() -> None:
    thing = harness.open_plume()
    thing.scale.z *= 1e-4
    assert np.isfinite(pictures.render(TINY)).all()


def test_no_light() -> None:
    harness.open_plume()
    for thing in list(bpy.context.scene.objects):
        if thing.type == "LIGHT":
            bpy.data.objects.remove(thing)
    assert pictures.render(TINY)[..., :3].max() == 0.0
    assert said("No light"), log.notices()


def lamp(name: str, kind: str, **settings: object) -> bpy.types.Object:
    """The sample with this light alone."""
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    harness.open_plume()
    for thing in list(bpy.context.scene.objects):
        if thing.type == "LIGHT":
            bpy.data.objects.remove(thing)
    data = bpy.data.lights.new(name, kind)
    data.energy = 500.0
    for key, value in settings.items():
        setattr(data, key, value)
    thing = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(thing)
    thing.location = (-2.0, -1.0, 3.0)
    return thing


def test_an_area_light_without_area() -> None:
    thing = lamp("Panel", "AREA", shape="RECTANGLE", size_y=0.0)
    assert np.isfinite(pictures.render(TINY)).all()
    assert said("Panel", "area"), log.notices()
    thing.data.size_y = 1.0
    thing.scale.x = 0.0
    assert np.isfinite(pictures.render(TINY)).all()
    assert said("Panel", "area"), log.notices()


def test_lights_inside_the_smoke() -> None:
    embers: tuple[tuple[str, dict[str, float]], ...] = (
        ("POINT", {"shadow_soft_size": 0.0}),
        ("POINT", {"shadow_soft_size": 2.0}),
        ("AREA", {}),
    )
    for kind, settings in embers:
        thing = lamp("Ember", kind, **settings)
        thing.location = harness.middle_of(bpy.context.scene.objects["Smoke Domain"])
        image = pictures.render(TINY)
        assert np.isfinite(image).all() and image[..., :3].max() > 0.0
        assert not log.notices(), log.notices()


def test_lights_far_away_and_on_the_floor() -> None:
    for location in ((0.0, 0.0, 1e7), (0.0, 0.0, 0.0)):
        thing = lamp("Beacon", "SPOT", energy=1e9, spot_size=0.02)
        thing.location = location
        assert np.isfinite(pictures.render(TINY)).all()


def test_a_lamp_of_minus_one_watt() -> None:
    lamp("Void", "POINT", energy=-1.0)
    assert pictures.render(TINY)[..., :3].max() == 0.0
    assert said("No light"), log.notices()


def wisps(count: int) -> None:
    data = bpy.data.volumes.new("Wisp")
    data.filepath = str(harness.ROOT / "blend_samples" / "frames" / "wisp.vdb")
    for number in range(count):
        thing = bpy.data.objects.new(f"Wisp {number}", data)
        thing.location.x = 0.1 * number
        bpy.context.scene.collection.objects.link(thing)


def test_more_smoke_than_the_viewport_has_room_for() -> None:
    harness.open_plume()
    plain = pictures.render(TINY)
    wisps(6)
    assert np.abs(pictures.render(TINY) - plain).max() > 0.01
    assert said("7 bodies of smoke: the viewport draws the 5 with the most in them, Smoke Domain, "), log.notices()


def test_more_smoke_than_there_is_room_for() -> None:
    harness.open_plume()
    wisps(64)
    assert np.isfinite(pictures.render(TINY)).all()
    assert said("only 64 bodies"), log.notices()


def shaded(thing: str, node: str, **values: float) -> None:
    """Give an object's material another shader; of two names for one socket, whichever this Blender has."""
    material = bpy.context.scene.objects[thing].active_material
    shader = material.node_tree.nodes.new(node)
    for names, value in values.items():
        for name in names.split("_or_"):
            if name.replace("_", " ") in shader.inputs:
                shader.inputs[name.replace("_", " ")].default_value = value
    output = material.node_tree.get_output_node("ALL")
    material.node_tree.links.new(shader.outputs[0], output.inputs["Surface"])


def test_gloss_is_shown_without_a_word() -> None:
    harness.open_plume()
    dull = pictures.render((160, 90))[..., :3]
    shaded("Ball", "ShaderNodeBsdfGlossy", Roughness=0.3)
    shaded("Block", "ShaderNodeBsdfPrincipled", Metallic=1.0, Roughness=0.4)
    shiny = pictures.render((160, 90))[..., :3]
    assert np.isfinite(shiny).all() and shiny.max() > 1.5 * dull.max(), "a highlight is brighter than anything diffuse"
    assert not log.notices(), log.notices()


def test_materials_that_are_not_modelled() -> None:
    harness.open_plume()
    shaded("Ball", "ShaderNodeBsdfToon")
    shaded("Block", "ShaderNodeBsdfPrincipled", Transmission_or_Transmission_Weight=1.0)
    assert pictures.render(TINY)[..., :3].max() > 0.0
    assert said("Ball", "Toon BSDF") and said("Block", "does not bend light"), log.notices()


def test_no_camera() -> None:
    harness.open_plume()
    bpy.context.scene.camera = None
    try:
        pictures.render(TINY)
    except RuntimeError as error:  # Blender's own refusal
        assert "camera" in str(error).lower()
    else:
        raise AssertionError("a picture without a camera")


def test_camera_inside_the_smoke() -> None:
    thing = harness.open_plume()
    bpy.context.scene.camera.location = harness.middle_of(thing)
    image = pictures.render(TINY)
    assert np.isfinite(image).all() and image[..., :3].max() > 0.0


def test_volume_without_its_file() -> None:
    harness.open_plume()
    data = bpy.data.volumes.new("Cloud")
    data.filepath = "/nowhere/cloud.vdb"
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Cloud", data))
    assert_an_error("Cloud", "/nowhere/cloud.vdb")
    assert pictures.render(TINY)[..., :3].max() > 0.0
    assert said("Cloud", "/nowhere/cloud.vdb"), log.notices()


def test_missing_native_module() -> None:
    """The add-on registers, its preferences explain, and a render says what is missing."""
    script = (
        "import bpy, sfumato.core as core\n"
        "assert 'SFUMATO_PT_render' in dir(bpy.types)\n"
        "assert 'native module' in core.problem() and 'README' in core.problem(), core.problem()\n"
        "bpy.context.scene.render.engine = 'SFUMATO'\n"
        "bpy.context.scene.render.resolution_percentage = 5\n"
        "try: bpy.ops.render.render()\n"
        "except RuntimeError as error: assert 'native module' in str(error)\n"
        "print('explained')\n"
    )
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / ("user_default" if harness.WHEEL else "addons") / "sfumato"
        shutil.copytree(Path(core.__file__).parent, copy, ignore=shutil.ignore_patterns("*.so"))
        place = {"BLENDER_USER_EXTENSIONS" if harness.WHEEL else "BLENDER_USER_SCRIPTS": folder}
        environment = {**os.environ, **place, "PYTHONDONTWRITEBYTECODE": "1"}
        command = harness.command(script)
        done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=120)
        assert "explained" in done.stdout, done.stdout + done.stderr  # the refused render sets the exit status


harness.main()
