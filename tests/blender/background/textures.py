# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials that vary over surfaces, beside the Cycles of this very Blender."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import bpy
import harness
import numpy as np
import pictures
import worlds
from sfumato.export import parts
from sfumato.export import scene as export

SIZE = (64, 48)


class Graph:
    """The nodes of the one material of a scene."""

    def __init__(self, shader: Any) -> None:
        self.shader, self.tree = shader, shader.id_data

    def node(self, kind: str, **settings: Any) -> Any:
        made = self.tree.nodes.new(f"ShaderNode{kind}")
        for name, value in settings.items():
            setattr(made, name, value)
        return made

    def link(self, output: Any, node: Any, name: str | int) -> Any:
        self.tree.links.new(output, node.inputs[name])
        return node

    def into(self, name: str, output: Any) -> None:
        self.tree.links.new(output, self.shader.inputs[name])

    def ramp(self, output: Any, *stops: tuple[float, tuple[float, ...]], how: str = "LINEAR") -> Any:
        node = self.link(output, self.node("ValToRGB"), 0)
        node.color_ramp.interpolation = how
        while len(node.color_ramp.elements) < len(stops):
            node.color_ramp.elements.new(0.5)
        for element, (position, colour) in zip(node.color_ramp.elements, stops):
            element.position, element.color = position, (*colour, 1.0)
        return node.outputs["Color"]

    def part(self, output: Any, axis: str) -> Any:
        return self.link(output, self.node("SeparateXYZ"), 0).outputs[axis]

    def math(self, operation: str, *numbers: Any) -> Any:
        node = self.node("Math", operation=operation)
        for number, value in enumerate(numbers):
            if isinstance(value, float):
                node.inputs[number].default_value = value
            else:
                self.link(value, node, number)
        return node.outputs[0]

    def coordinates(self, which: str) -> Any:
        return self.node("TexCoord").outputs[which]


BLUE_TO_RED = (0.1, (0.05, 0.1, 0.7)), (0.9, (0.9, 0.2, 0.1))


def scene(thing: str = "floor") -> Graph:
    """Something with a material under a sun and a lamp."""
    bpy.ops.wm.read_homefile(use_empty=True)
    harness.black_world()
    if thing == "floor":
        bpy.ops.mesh.primitive_grid_add(size=6.0, x_subdivisions=5, y_subdivisions=3)
    else:
        bpy.ops.mesh.primitive_monkey_add(size=3.0, location=(0.0, 0.0, 0.3))
        bpy.ops.object.shade_smooth()
        bpy.context.object.modifiers.new("Fine", "SUBSURF").levels = 3
        bpy.context.object.modifiers["Fine"].render_levels = 3
    found = bpy.context.object
    shader = harness.shade(found.data, "ShaderNodeBsdfPrincipled")
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy, sun.rotation_euler = 2.0, (0.5, 0.3, 0.0)
    lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "AREA"))
    lamp.data.energy, lamp.data.size, lamp.location = 200.0, 1.5, (1.0, 1.5, 3.0)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location, camera.rotation_euler = (0.0, -6.0, 4.0), (0.98, 0.0, 0.0)
    for each in (sun, lamp, camera):
        bpy.context.scene.collection.objects.link(each)
    bpy.context.scene.camera = camera
    return Graph(shader)


def generated_ramp(graph: Graph) -> None:
    graph.into("Base Color", graph.ramp(graph.part(graph.coordinates("Generated"), "X"), *BLUE_TO_RED))


def own_gradient(graph: Graph) -> None:
    node = graph.link(graph.coordinates("Object"), graph.node("TexGradient", gradient_type="SPHERICAL"), 0)
    graph.into("Base Color", graph.ramp(node.outputs[1], *BLUE_TO_RED, how="EASE"))


def uv_mapped(graph: Graph) -> None:
    mapping = graph.link(graph.node("UVMap").outputs[0], graph.node("Mapping"), "Vector")
    mapping.inputs["Rotation"].default_value = (0.0, 0.0, 0.5)
    mapping.inputs["Scale"].default_value = (3.0, 2.0, 1.0)
    wave = graph.math("SINE", graph.math("MULTIPLY", graph.part(mapping.outputs[0], "Y"), 6.0))
    graph.into("Base Color", graph.ramp(wave, *BLUE_TO_RED))


def roughness(graph: Graph) -> None:
    graph.into("Roughness", graph.part(graph.coordinates("Generated"), "X"))


def rough_metal(graph: Graph) -> None:
    graph.into("Roughness", graph.math("ADD", graph.part(graph.coordinates("Generated"), "Y"), 0.15))
    graph.into("Metallic", graph.part(graph.coordinates("Generated"), "X"))
    graph.into("Base Color", graph.ramp(graph.part(graph.coordinates("Generated"), "Z"), *BLUE_TO_RED))


def specular(graph: Graph) -> None:
    name = "Specular" if "Specular" in graph.shader.inputs else "Specular IOR Level"
    graph.into(name, graph.part(graph.coordinates("Generated"), "X"))
    graph.shader.inputs["Roughness"].default_value = 0.3


def alpha(graph: Graph) -> None:
    graph.into("Alpha", graph.part(graph.coordinates("Generated"), "X"))


def glow(graph: Graph) -> None:
    name = "Emission Color" if "Emission Color" in graph.shader.inputs else "Emission"
    graph.into(name, graph.ramp(graph.part(graph.coordinates("Generated"), "X"), *BLUE_TO_RED))
    graph.shader.inputs["Emission Strength"].default_value = 0.5


def facing(graph: Graph) -> None:
    graph.into("Base Color", graph.ramp(graph.node("LayerWeight").outputs["Facing"], *BLUE_TO_RED))
    graph.into("Roughness", graph.math("SUBTRACT", 1.0, graph.node("Fresnel").outputs[0]))


def bump(graph: Graph) -> None:
    at = graph.coordinates("Object")
    height = graph.math("SINE", graph.math("MULTIPLY", graph.part(at, "X"), 5.0))
    node = graph.link(height, graph.node("Bump"), "Height")
    node.inputs["Distance"].default_value = 0.15
    graph.into("Normal", node.outputs[0])


def normal_map(graph: Graph) -> None:
    at = graph.part(graph.coordinates("UV"), "X")
    slope = graph.math("ADD", graph.math("MULTIPLY", graph.math("SINE", graph.math("MULTIPLY", at, 20.0)), 0.2), 0.5)
    colour = graph.link(slope, graph.node("CombineXYZ"), 0)
    colour.inputs[1].default_value, colour.inputs[2].default_value = 0.5, 1.0
    node = graph.link(colour.outputs[0], graph.node("NormalMap", uv_map=""), "Color")
    node.inputs["Strength"].default_value = 0.7
    graph.into("Normal", node.outputs[0])


def mirrored_normal_map(graph: Graph) -> None:
    """Of an object that is uneven besides, by what tells both directions of a map."""
    bpy.context.object.scale = (-1.0, 0.6, 1.0)
    at = graph.part(graph.coordinates("UV"), "Y")
    slope = graph.math("ADD", graph.math("MULTIPLY", graph.math("SINE", graph.math("MULTIPLY", at, 20.0)), 0.2), 0.5)
    colour = graph.link(slope, graph.node("CombineXYZ"), 1)
    colour.inputs[0].default_value, colour.inputs[2].default_value = 0.55, 1.0
    graph.into("Normal", graph.link(colour.outputs[0], graph.node("NormalMap"), "Color").outputs[0])


def brushed(graph: Graph) -> None:
    graph.shader.inputs["Metallic"].default_value = 1.0
    graph.into("Anisotropic", graph.part(graph.coordinates("Generated"), "X"))


def attribute(graph: Graph) -> None:
    mesh = bpy.context.object.data
    tint = mesh.attributes.new("tint", "FLOAT_COLOR", "POINT")
    tint.data.foreach_set("color", np.random.default_rng(3).random(4 * len(mesh.vertices)).astype(np.float32))
    rough = mesh.attributes.new("rough", "FLOAT", "FACE")
    rough.data.foreach_set("value", np.linspace(0.2, 1.0, len(mesh.polygons)).astype(np.float32))
    graph.into("Base Color", graph.node("Attribute", attribute_name="tint").outputs["Color"])
    graph.into("Roughness", graph.node("Attribute", attribute_name="rough").outputs["Fac"])


def object_info(graph: Graph) -> None:
    bpy.context.object.color = (0.2, 0.7, 0.4, 1.0)
    node = graph.node("ObjectInfo")
    graph.into("Base Color", node.outputs["Color"])
    graph.into("Roughness", node.outputs["Random"])


def mixed_shaders(graph: Graph) -> None:
    tree = graph.tree
    other, mix = graph.node("BsdfGlossy"), graph.node("MixShader")
    other.inputs["Roughness"].default_value = 0.4
    graph.link(graph.part(graph.coordinates("Generated"), "X"), mix, 0)
    graph.link(graph.shader.outputs[0], mix, 1)
    graph.link(other.outputs[0], mix, 2)
    output = next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL")
    graph.link(mix.outputs[0], output, "Surface")


def textured(graph: Graph, kind: str, output: int | str = 0, scale: float = 2.0, **settings: Any) -> Any:
    """The output of a texture of the object's own coordinates; what settings a Blender lacks, it does without."""
    node = graph.link(graph.coordinates("Object"), graph.node(kind), "Vector")
    for name, value in settings.items():
        if hasattr(node, name):
            setattr(node, name, value)
        elif name.replace("_", " ") in node.inputs:
            node.inputs[name.replace("_", " ")].default_value = value
    if "Scale" in node.inputs:
        node.inputs["Scale"].default_value = scale
    return node.outputs[output]


def noise(graph: Graph) -> None:
    graph.into("Base Color", graph.ramp(textured(graph, "TexNoise", Detail=4.0, Roughness=0.6), *BLUE_TO_RED))


def coloured_noise(graph: Graph) -> None:
    graph.into("Base Color", textured(graph, "TexNoise", 1, Detail=1.0, Distortion=0.7, noise_dimensions="4D"))


def voronoi(graph: Graph) -> None:
    graph.into("Base Color", textured(graph, "TexVoronoi", "Color", feature="SMOOTH_F1"))
    graph.into("Roughness", textured(graph, "TexVoronoi", "Distance", feature="F2"))


def cracks(graph: Graph) -> None:
    edge = textured(graph, "TexVoronoi", "Distance", feature="DISTANCE_TO_EDGE", voronoi_dimensions="2D")
    graph.into("Base Color", graph.ramp(edge, (0.0, (0.0, 0.0, 0.0)), (0.1, (0.8, 0.7, 0.6))))


def checker(graph: Graph) -> None:
    graph.into("Base Color", textured(graph, "TexChecker"))


def brick(graph: Graph) -> None:
    graph.into("Base Color", textured(graph, "TexBrick", squash=0.7, squash_frequency=3))


def magic_and_wave(graph: Graph) -> None:
    graph.into("Base Color", textured(graph, "TexMagic", turbulence_depth=3))
    graph.into("Roughness", textured(graph, "TexWave", 1, Distortion=3.0, Detail=2.0, wave_type="RINGS"))


def noisy_bump(graph: Graph) -> None:
    node = graph.link(textured(graph, "TexNoise", scale=1.5), graph.node("Bump"), "Height")
    node.inputs["Distance"].default_value = 0.4
    graph.into("Normal", node.outputs[0])


def pixels(size: int, fine: bool = False) -> Any:
    """Colors that differ from side to side, with clear corners; fine ones change from texel to texel."""
    random = np.random.default_rng(5)
    v, u = np.mgrid[0:size, 0:size] / size
    rgba = np.stack([u, 0.5 + 0.5 * np.sin(9.0 * v), 1.0 - u * v, np.where((u < 0.3) & (v < 0.4), 0.25, 1.0)], axis=2)
    if fine:
        rgba[..., :3] = random.random((size, size, 3))
    return rgba.astype(np.float32)


def image_node(graph: Graph, size: int = 16, repeated: float = 3.0, **settings: Any) -> Any:
    node = graph.node("TexImage", image=worlds.image(pixels(size, settings.pop("fine", False)), floats=False))
    mapping = graph.link(graph.node("UVMap").outputs[0], graph.node("Mapping"), "Vector")
    mapping.inputs["Rotation"].default_value = (0.0, 0.0, 0.3)
    mapping.inputs["Scale"].default_value = (repeated, repeated, 1.0)
    graph.link(mapping.outputs[0], node, "Vector")
    for name, value in settings.items():
        setattr(node, name, value)
    return node


def image(graph: Graph) -> None:
    graph.into("Base Color", image_node(graph).outputs["Color"])


def closest_image(graph: Graph) -> None:
    graph.into("Base Color", image_node(graph, interpolation="Closest", extension="EXTEND").outputs["Color"])


def cubic_image(graph: Graph) -> None:
    graph.into("Base Color", image_node(graph, 8, 1.5, interpolation="Cubic", extension="CLIP").outputs["Color"])


def fine_image(graph: Graph) -> None:
    """Many texels a pixel."""
    graph.into("Base Color", image_node(graph, 512, 2.0, fine=True).outputs["Color"])


def image_with_alpha(graph: Graph) -> None:
    node = image_node(graph)
    graph.into("Base Color", node.outputs["Color"])
    graph.into("Alpha", node.outputs["Alpha"])


def projected(graph: Graph, projection: str, which: str) -> None:
    node = graph.node("TexImage", image=worlds.image(pixels(16), floats=False), projection=projection)
    node.projection_blend = 0.3
    graph.link(graph.coordinates(which), node, "Vector")
    graph.into("Base Color", node.outputs["Color"])


def image_around_a_sphere(graph: Graph) -> None:
    projected(graph, "SPHERE", "Generated")


def image_around_a_tube(graph: Graph) -> None:
    projected(graph, "TUBE", "Generated")


def image_on_a_box(graph: Graph) -> None:
    projected(graph, "BOX", "Object")


def image_of_data(graph: Graph) -> None:
    node = image_node(graph)
    made = bpy.data.images.new("Data", 16, 16, is_data=True)
    made.pixels.foreach_set(pixels(16).ravel())
    made.update()
    node.image = made
    graph.into("Roughness", node.outputs["Color"])


# On what, and how far from Cycles, mean over blocks of 4 pixels relative to the mean, at most.
CASES: dict[Callable[[Graph], None], tuple[str, float]] = {
    generated_ramp: ("floor", 0.01),
    own_gradient: ("monkey", 0.015),
    uv_mapped: ("floor", 0.01),
    roughness: ("floor", 0.01),
    rough_metal: ("monkey", 0.025),
    specular: ("floor", 0.01),
    alpha: ("floor", 0.01),
    glow: ("floor", 0.01),
    facing: ("monkey", 0.02),
    bump: ("floor", 0.015),
    normal_map: ("floor", 0.015),
    mirrored_normal_map: ("monkey", 0.04),
    brushed: ("floor", 0.02),
    attribute: ("monkey", 0.015),
    object_info: ("floor", 0.01),
    mixed_shaders: ("monkey", 0.015),
    noise: ("floor", 0.01),
    coloured_noise: ("monkey", 0.015),
    voronoi: ("floor", 0.01),
    cracks: ("floor", 0.01),
    checker: ("floor", 0.01),
    brick: ("floor", 0.015),
    magic_and_wave: ("floor", 0.015),
    noisy_bump: ("floor", 0.015),
    image: ("floor", 0.01),
    closest_image: ("floor", 0.015),
    cubic_image: ("floor", 0.01),
    fine_image: ("floor", 0.02),
    image_with_alpha: ("floor", 0.015),
    image_of_data: ("floor", 0.015),
    image_around_a_sphere: ("monkey", 0.025),
    image_around_a_tube: ("monkey", 0.025),
    image_on_a_box: ("monkey", 0.02),
}


# Of which Cycles makes something else from 4.0 on: 5.2.2.
BENT = {bump, noisy_bump, mirrored_normal_map}


def test_what_varies_is_as_in_cycles() -> None:
    wrong = []
    for case, (thing, most) in CASES.items():
        graph = scene(thing)
        case(graph)
        error = pictures.error_beside_cycles(case.__name__, SIZE, 64)
        said = harness.said()
        print(f"{case.__name__}: {error:.4f}, {said}")
        most *= 2.5 if case in BENT and bpy.app.version >= (4, 0, 0) else 1.0
        if not error < most or (said and case is not glow):
            wrong.append(f"{case.__name__}: {error:.4f} of at most {most}, {said}")
    assert not wrong, "\n".join(wrong)


def test_what_is_plain_stands_beside_what_varies() -> None:
    """Objects without maps and attributes before one that has them, a textured leaf that throws its shadow, and a lamp."""
    graph = scene()
    graph.into("Base Color", image_node(graph).outputs["Color"])
    bpy.ops.mesh.primitive_cube_add(size=0.8, location=(1.2, 0.3, 0.6))
    bpy.ops.mesh.primitive_plane_add(size=1.5, location=(-1.0, 0.0, 1.0))
    leaf = Graph(harness.shade(bpy.context.object.data, "ShaderNodeBsdfPrincipled"))
    leaf.into("Alpha", leaf.math("GREATER_THAN", textured(leaf, "TexVoronoi", "Distance"), 0.4))
    assert pictures.error_beside_cycles("beside each other", SIZE, 64) < 0.03
    assert not harness.said(), harness.said()


def test_what_is_wrong_with_a_texture_is_named() -> None:
    graph = scene()
    node = graph.node("TexImage")
    graph.into("Base Color", node.outputs["Color"])
    pictures.render(SIZE)
    assert harness.said() == ["Grid: a texture has no image; it is magenta"], harness.said()
    node.image = worlds.image(pixels(4), floats=False)
    bpy.context.object.data.uv_layers.remove(bpy.context.object.data.uv_layers[0])
    bpy.context.object.data.update_tag()
    pictures.render(SIZE)
    assert len(harness.said()) == 1 and "no UV map" in harness.said()[0], harness.said()
    graph.into("Base Color", graph.node("Attribute", attribute_name="nothing").outputs["Color"])
    pictures.render(SIZE)
    assert len(harness.said()) == 1 and "no attribute 'nothing'" in harness.said()[0], harness.said()
    value = graph.part(graph.coordinates("Generated"), "X")
    for _ in range(300):
        value = graph.math("MULTIPLY", value, 0.999)
    graph.into("Base Color", value)
    pictures.render(SIZE)
    # Newer Pythons follow them all.
    assert all("too many nodes in a row" in line for line in harness.said()), harness.said()


def test_nothing_is_made_again_unless_it_changed() -> None:
    graph = scene()
    graph.into("Base Color", graph.ramp(image_node(graph).outputs["Color"], *BLUE_TO_RED))
    kept = parts.Parts(told=True)

    def patterns() -> set[int]:
        depsgraph = bpy.context.evaluated_depsgraph_get()
        export.export(depsgraph, kept)
        return {id(part) for part in kept._made.values() if type(part).__name__ in {"Pattern", "Image"}}

    first = patterns()
    assert len(first) == 2 and patterns() == first
    ramp = next(node for node in graph.tree.nodes if node.type == "VALTORGB")
    ramp.color_ramp.elements[0].position = 0.3
    assert len(patterns() & first) == 1


harness.main()
