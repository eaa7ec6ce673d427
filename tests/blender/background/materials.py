# SPDX-License-Identifier: GPL-3.0-or-later
"""What a material makes of a sun: a floor, seen from an angle, as bright as the Cycles of this very Blender makes it.

Each case is there for something that Cycles does differently in another version (addon/compat.py), or for an input.
"""

import math

import bpy
import harness
import pictures
from sfumato import log  # type: ignore[attr-defined]

SIZE = (8, 8)
GREY, COPPER = (0.8, 0.8, 0.8, 1.0), (0.9, 0.5, 0.3, 1.0)
WHITE, DARK, TEAL = (1.0, 1.0, 1.0, 1.0), (0.2, 0.2, 0.2, 1.0), (0.2, 0.6, 0.7, 1.0)
# Shader, its inputs and settings, the sun's angle to the normal, and the eye's on the other side; negative on the same side.
Case = tuple[str, dict[str, object], float, float]
PRINCIPLED, GLOSSY, DIFFUSE = "ShaderNodeBsdfPrincipled", "ShaderNodeBsdfGlossy", "ShaderNodeBsdfDiffuse"
BRUSHED = "ShaderNodeBsdfAnisotropic"  # a Glossy BSDF from 4.0 on
METAL = {"Base Color": COPPER, "Metallic": 1.0}
TINTED = {"Base Color": GREY, "Metallic": 1.0, "Specular Tint": TEAL}
BLACK = (0.0, 0.0, 0.0, 1.0)
GLOWING = {"Emission": GREY, "Emission Color": GREY, "Emission Strength": 2.0}
VELVET, FUZZ = "ShaderNodeBsdfVelvet", "ShaderNodeBsdfSheen"
DULL = {"Specular": 0.0, "Specular IOR Level": 0.0}
CLEARCOAT = {"Clearcoat": 1.0, "Base Color": BLACK, "Specular": 0.0}
GGX = {"Color": COPPER, "Roughness": 0.5, "distribution": "GGX"}
BECKMANN = {"Color": COPPER, "Roughness": 0.5, "distribution": "BECKMANN"}
CASES: dict[str, Case] = {
    "diffuse": ("ShaderNodeBsdfDiffuse", {"Color": GREY}, 30.0, -60.0),
    "default, from above": (PRINCIPLED, {}, 30.0, -10.0),
    "default, from 60 degrees": (PRINCIPLED, {}, 30.0, -60.0),
    "default, mirrored": (PRINCIPLED, {}, 40.0, 40.0),
    "default, grazing": (PRINCIPLED, {}, 78.0, 78.0),
    "smooth, from 75 degrees": (PRINCIPLED, {"Roughness": 0.2}, 30.0, -75.0),
    "rough, from 80 degrees": (PRINCIPLED, {"Roughness": 1.0}, 80.0, -80.0),
    "index 2": (PRINCIPLED, {"IOR": 2.0}, 40.0, 40.0),
    "no specular": (PRINCIPLED, {"Specular": 0.0, "Specular IOR Level": 0.0, "Roughness": 1.0}, 70.0, -70.0),
    "much specular": (PRINCIPLED, {"Specular": 1.0, "Specular IOR Level": 1.0}, 40.0, 40.0),
    "metal": (PRINCIPLED, METAL, 40.0, 40.0),
    "metal, grazing": (PRINCIPLED, {**METAL, "Roughness": 0.3}, 78.0, 78.0),
    "rough metal": (PRINCIPLED, {**METAL, "Roughness": 1.0}, 40.0, -40.0),
    "rough metal, grazing": (PRINCIPLED, {**METAL, "Roughness": 1.0}, 75.0, -75.0),
    "glossy": (GLOSSY, {"Color": COPPER, "Roughness": 0.5}, 40.0, 40.0),
    "rough glossy": (GLOSSY, {"Color": COPPER, "Roughness": 1.0}, 75.0, -75.0),
    "glow": (PRINCIPLED, {"Emission": GREY, "Emission Color": GREY, "Emission Strength": 2.0}, 30.0, -10.0),
    "rough diffuse, towards the light": (DIFFUSE, {"Color": GREY, "Roughness": 1.0}, 60.0, 60.0),
    "rough diffuse, from the light": (DIFFUSE, {"Color": GREY, "Roughness": 1.0}, 60.0, -60.0),
    "rough diffuse, half": (DIFFUSE, {"Color": GREY, "Roughness": 0.5}, 75.0, -30.0),
    "rough diffuse, dark": (DIFFUSE, {"Color": DARK, "Roughness": 1.0}, 75.0, -75.0),
    "rough diffuse, white": (DIFFUSE, {"Color": WHITE, "Roughness": 1.0}, 75.0, -75.0),
    "Diffuse Roughness": (PRINCIPLED, {"Diffuse Roughness": 1.0}, 60.0, -60.0),
    "Diffuse Roughness, in the other direction": (PRINCIPLED, {"Diffuse Roughness": 1.0}, 70.0, 50.0),
    "tinted specular": (PRINCIPLED, {"Base Color": TEAL, "Specular Tint": TEAL, "Roughness": 0.3}, 40.0, 40.0),
    "tinted metal": (PRINCIPLED, TINTED, 60.0, 60.0),
    "half metal": (PRINCIPLED, {"Base Color": COPPER, "Metallic": 0.5}, 40.0, 40.0),
    "half metal, grazing": (PRINCIPLED, {"Base Color": COPPER, "Metallic": 0.5}, 75.0, 75.0),
    "half metal, rough": (PRINCIPLED, {"Base Color": COPPER, "Metallic": 0.6, "Roughness": 1.0}, 75.0, -40.0),
    "a third metal, from above": (PRINCIPLED, {"Base Color": COPPER, "Metallic": 0.3, "Roughness": 0.7}, 50.0, -20.0),
    "Beckmann": (GLOSSY, BECKMANN, 40.0, 40.0),
    "Beckmann, aside": (GLOSSY, BECKMANN, 20.0, 50.0),
    "rough Beckmann": (GLOSSY, {**BECKMANN, "Roughness": 1.0}, 75.0, -40.0),
    "GGX": (GLOSSY, {**GGX, "Roughness": 0.8}, 60.0, -40.0),
    "Multiscatter GGX": (GLOSSY, {"Color": COPPER, "Roughness": 0.8, "distribution": "MULTI_GGX"}, 60.0, -40.0),
    "Principled of single GGX": (PRINCIPLED, {"distribution": "GGX", "Roughness": 1.0}, 60.0, -40.0),
    "Principled of Multiscatter GGX": (PRINCIPLED, {"distribution": "MULTI_GGX", "Roughness": 1.0}, 60.0, -40.0),
    "Thin Wall": (PRINCIPLED, {"Thin Wall": True, "Roughness": 0.3}, 40.0, 20.0),
    "coat, aside": (PRINCIPLED, {"Coat Weight": 1.0, "Base Color": COPPER}, 40.0, -60.0),
    "index of 1": (PRINCIPLED, {"IOR": 1.0, "Roughness": 0.4}, 40.0, 40.0),
    "index of 3, little level": (PRINCIPLED, {"IOR": 3.0, "Specular IOR Level": 0.2, "Roughness": 0.4}, 60.0, 60.0),
    "tinted specular, the layer below": (
        PRINCIPLED,
        {"Base Color": GREY, "Specular Tint": TEAL, "IOR": 2.0},
        40.0,
        -40.0,
    ),
    "tinted metal, grazing": (PRINCIPLED, {**TINTED, "Roughness": 0.3}, 80.0, 80.0),
    "tinted rough metal": (PRINCIPLED, {**TINTED, "Roughness": 1.0}, 75.0, -40.0),
    "metal of single GGX": (PRINCIPLED, {**METAL, "distribution": "GGX", "Roughness": 1.0}, 60.0, -40.0),
    "brushed, turned": (PRINCIPLED, {**METAL, "Anisotropic": 0.8, "Anisotropic Rotation": 0.2}, 40.0, 20.0),
    "brushed Glossy": (BRUSHED, {**GGX, "Anisotropy": 0.5}, 40.0, 20.0),
    "Glossy, brushed across": (BRUSHED, {**GGX, "Anisotropy": -0.5}, 40.0, 20.0),
    "Glossy, turned": (BRUSHED, {**BECKMANN, "Anisotropy": 0.5, "Rotation": 0.1}, 40.0, 20.0),
    "coat, mirrored": (PRINCIPLED, {"Coat Weight": 1.0, "Coat Roughness": 0.3}, 40.0, 40.0),
    "glow under a tinted coat": (PRINCIPLED, {**GLOWING, "Coat Weight": 0.8, "Coat Tint": TEAL}, 40.0, -60.0),
    "Translucent, from behind": ("ShaderNodeBsdfTranslucent", {"Color": COPPER}, 150.0, -20.0),
    "Velvet": (VELVET, {"Color": COPPER, "Sigma": 0.5}, 40.0, -60.0),
    "Velvet, against the light": (VELVET, {"Color": COPPER, "Sigma": 1.0}, 70.0, -20.0),
    "Sheen as Velvet": (FUZZ, {"Color": COPPER, "Roughness": 0.5, "distribution": "ASHIKHMIN"}, 40.0, -60.0),
    "half a coat over metal": (PRINCIPLED, {**METAL, "Coat Weight": 0.5, "Coat IOR": 2.0}, 40.0, 20.0),
}
# What is named with its value, and what is shown instead, where a Blender has it.
NAMED: dict[str, tuple[str, dict[str, object], str]] = {
    "Ashikhmin": (GLOSSY, {"distribution": "ASHIKHMIN_SHIRLEY"}, "Ashikhmin-Shirley, is shown as GGX"),
    "index below 1": (PRINCIPLED, {"IOR": 0.8, "Specular IOR Level": 0.5}, "its IOR of 0.8 is shown as 1.25"),
    "a mirror": (PRINCIPLED, {"Roughness": 0.04}, "its Roughness of 0.04 is shown as 0.1 where it shows lamps"),
    "thin fibres": (
        PRINCIPLED,
        {"Sheen Weight": 0.5, "Sheen Roughness": 0.1},
        "its Sheen Roughness of 0.1 is shown as 0.15",
    ),
}


if bpy.app.version < (4, 0, 0):
    CASES["white Sheen"] = (PRINCIPLED, {"Sheen": 0.7, "Base Color": GREY, **DULL}, 75.0, 60.0)
    CASES["Sheen"] = (PRINCIPLED, {"Sheen": 1.0, "Sheen Tint": 0.5, "Base Color": TEAL, **DULL}, 70.0, 75.0)
    NAMED["a smooth clearcoat"] = (
        PRINCIPLED,
        {"Clearcoat": 1.0, "Clearcoat Roughness": 0.03},
        "the sharpest of its Clearcoat of Roughness 0.03 is shown as of 0.1",
    )
    NAMED["random walks"] = (GLOSSY, {"distribution": "MULTI_GGX"}, "Multiscatter GGX, is shown as GGX")
    NAMED["random walks of a Principled BSDF"] = (PRINCIPLED, *NAMED["random walks"][1:])


def set_inputs(node: bpy.types.ShaderNode, inputs: dict[str, object]) -> bool:
    """Of inputs that have other names in other versions, those that are there are set. Whether all are."""
    there = True
    for name, value in inputs.items():
        if name == "distribution":
            there = there and value in node.bl_rna.properties[name].enum_items
            if value in node.bl_rna.properties[name].enum_items:
                node.distribution = value
        elif name in node.inputs:
            socket = node.inputs[name]
            number = isinstance(socket.default_value, float)  # a tint before 4.0
            socket.default_value = 1.0 if number and isinstance(value, tuple) else value
        else:
            there = False
    return there


def arrange(shader: str, inputs: dict[str, object], sun_angle: float, eye_angle: float) -> bpy.types.ShaderNode:
    """A floor of one shader, which is given back."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    harness.enable()
    bpy.ops.mesh.primitive_plane_add(size=40.0)
    node = harness.shade(bpy.context.object.data, shader)
    set_inputs(node, inputs)
    light, camera = bpy.data.lights.new("Sun", "SUN"), bpy.data.cameras.new("Camera")
    light.energy, light.angle = math.pi, 0.0
    camera.type, camera.ortho_scale = "ORTHO", 0.5
    scene = bpy.context.scene
    sun, scene.camera = bpy.data.objects.new("Sun", light), bpy.data.objects.new("Camera", camera)
    sun.rotation_euler = (-math.radians(sun_angle), 0.0, 0.0)
    turn = math.radians(eye_angle)
    scene.camera.location = (0.0, -10.0 * math.sin(turn), 10.0 * math.cos(turn))
    scene.camera.rotation_euler = (turn, 0.0, 0.0)
    for thing in (sun, scene.camera):
        scene.collection.objects.link(thing)
    scene.world = None
    scene.sfumato.quality = "FINAL"
    scene.render.resolution_percentage = 100
    return node


def test_a_material_is_cycles() -> None:
    wrong = {}
    for name, case in CASES.items():
        if not hasattr(bpy.types, case[0]):
            continue
        if bpy.app.version < (4, 0, 0) and case[1].get("distribution") == "MULTI_GGX":
            continue  # random walks between facets, which are named
        arrange(*case)
        ratio = pictures.beside_cycles(name, SIZE, 16)
        if abs(ratio - 1.0) > 0.01:
            wrong[name] = ratio
    assert not wrong, wrong


# What is shown nearly as it is, and how nearly.
NEARLY: dict[str, tuple[Case, float]] = {
    "clearcoat, mirrored": ((PRINCIPLED, {**CLEARCOAT, "Clearcoat Roughness": 0.3}, 40.0, 40.0), 0.01),
    "clearcoat, aside": ((PRINCIPLED, {**CLEARCOAT, "Clearcoat Roughness": 0.3}, 40.0, 20.0), 0.02),
    # There masking counts, which goes by the eye alone.
    "clearcoat, grazing": ((PRINCIPLED, {**CLEARCOAT, "Clearcoat Roughness": 0.5}, 75.0, 70.0), 0.06),
    "half a rough clearcoat": (
        (PRINCIPLED, {**CLEARCOAT, "Clearcoat": 0.5, "Clearcoat Roughness": 1.0}, 40.0, 20.0),
        0.1,
    ),
    "clearcoat over a default": ((PRINCIPLED, {"Clearcoat": 1.0, "Clearcoat Roughness": 0.2}, 75.0, 70.0), 0.03),
}


FIBRES = {"Sheen Weight": 1.0, "Base Color": GREY, **DULL}
if bpy.app.version >= (4, 0, 0):
    NEARLY = {
        "tinted coat": (
            (
                PRINCIPLED,
                {"Base Color": GREY, "Coat Weight": 0.8, "Coat Roughness": 0.3, "Coat Tint": TEAL},
                40.0,
                -60.0,
            ),
            0.02,
        ),
        "fibres, aside": ((PRINCIPLED, {**FIBRES, "Sheen Roughness": 0.5}, 40.0, -60.0), 0.02),
        "fibres, against the light": ((PRINCIPLED, {**FIBRES, "Sheen Roughness": 0.5}, 70.0, 75.0), 0.03),
        "fibres, towards the light": ((PRINCIPLED, {**FIBRES, "Sheen Roughness": 0.3}, 70.0, -75.0), 0.03),
        "fibres, coloured": ((PRINCIPLED, {**FIBRES, "Sheen Tint": COPPER, "Sheen Roughness": 0.7}, 60.0, -70.0), 0.03),
        "fibres, rough": ((PRINCIPLED, {**FIBRES, "Sheen Roughness": 1.0}, 30.0, -50.0), 0.03),
        "fibres alone": ((FUZZ, {"Color": COPPER, "Roughness": 0.5, "distribution": "MICROFIBER"}, 60.0, -70.0), 0.05),
    }


def test_clearcoats_and_fibres_are_nearly_cycles() -> None:
    wrong = {}
    for name, (case, most) in NEARLY.items():
        arrange(*case)
        ratio = pictures.beside_cycles(name, SIZE, 64)
        if abs(ratio - 1.0) > most:
            wrong[name] = ratio
        assert not log.notices(), (name, log.notices())
    assert not wrong, wrong


Shader = tuple[str, dict[str, object]]
LAMBERT: Shader = (DIFFUSE, {"Color": GREY})
PAIRS: dict[str, tuple[Shader, Shader, float | None]] = {
    "Mix of Diffuse and Glossy": (LAMBERT, (GLOSSY, GGX), 0.3),
    "Mix of Glossy and Diffuse": ((GLOSSY, GGX), LAMBERT, 0.3),
    "Mix of two Glossies": ((GLOSSY, BECKMANN), (GLOSSY, {**GGX, "Roughness": 0.2}), 0.6),
    "Mix of Principled and Glossy": ((PRINCIPLED, {"Base Color": TEAL}), (GLOSSY, GGX), 0.5),
    "Mix of two Diffuses": (LAMBERT, (DIFFUSE, {"Color": DARK}), 0.4),
    "Mix of Principled and Emission": ((PRINCIPLED, {}), ("ShaderNodeEmission", {"Strength": 2.0}), 0.3),
    "Mix with nothing": (LAMBERT, ("", {}), 0.4),
    "Diffuse and Glossy added": (LAMBERT, (GLOSSY, GGX), None),
    "Diffuse and Emission added": (LAMBERT, ("ShaderNodeEmission", {"Strength": 0.5}), None),
}


def pair(first: Shader, second: Shader, factor: float | None) -> bpy.types.ShaderNode:
    """A floor of two shaders, mixed by a factor, or added."""
    top = arrange(*first, 40.0, 30.0)
    tree = top.id_data
    joint = tree.nodes.new("ShaderNodeAddShader" if factor is None else "ShaderNodeMixShader")
    if factor is not None:
        joint.inputs[0].default_value = factor
    output = tree.nodes["Material Output"]
    tree.links.new(joint.outputs[0], output.inputs["Surface"])
    sockets = joint.inputs[-2:]
    tree.links.new(top.outputs[0], sockets[0])
    if second[0]:
        node = tree.nodes.new(second[0])
        set_inputs(node, second[1])
        tree.links.new(node.outputs[0], sockets[1])
    return joint


def test_two_shaders_are_cycles() -> None:
    wrong = {}
    for name, case in PAIRS.items():
        pair(*case)
        ratio = pictures.beside_cycles(name, SIZE, 16)
        if abs(ratio - 1.0) > 0.01:
            wrong[name] = ratio
        assert not log.notices(), (name, log.notices())
    assert not wrong, wrong


def test_two_shaders_that_cover_each_other_are_named() -> None:
    """Of two Principled BSDFs each has a diffuse part that the other's gloss does not dim."""
    pair((PRINCIPLED, {}), (PRINCIPLED, {"Roughness": 0.2}), 0.5)
    pictures.render(SIZE)
    assert any("their gloss is one between the two" in notice for notice in log.notices()), log.notices()


def test_what_is_not_followed_is_named_with_its_value() -> None:
    for name, (shader, inputs, words) in NAMED.items():
        node = arrange(shader, {}, 40.0, 40.0)
        pictures.render(SIZE)
        assert not log.notices(), (name, log.notices())
        if set_inputs(node, inputs):
            pictures.render(SIZE)
            said = [notice for notice in log.notices() if words in notice]
            assert len(said) == 1 and len(log.notices()) == 1, (name, log.notices())


harness.main()
