# SPDX-License-Identifier: GPL-3.0-or-later
"""The nodes of volume materials: what each calculates, and what they make of smoke and fire, beside Cycles."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import bpy
import harness
import numpy as np
import pictures
from sfumato.export.shading import fields, reading

# Cycles has ramps at these places alone.
VALUES = np.concatenate((np.arange(0, 256, 5) / 255.0, (-1.3, -0.4, 1.25, 2.5))).astype(np.float32).astype(np.float64)
OTHERS = (VALUES[::-1] * 0.7 + 0.1) % 1.0
Build = Callable[[Any, Any, Any, Any], Any]  # of a tree and the sockets of two numbers and a colour: the colour's


def node(tree: Any, kind: str, *inputs: Any, **settings: Any) -> Any:
    """A node of some settings, whose inputs, in the order of those that it then has, are linked to sockets or set."""
    made = tree.nodes.new(f"ShaderNode{kind}")
    for name, value in settings.items():
        setattr(made, name, value)
    for socket, value in zip((socket for socket in made.inputs if socket.enabled), inputs):
        if isinstance(value, bpy.types.NodeSocket):
            tree.links.new(value, socket)
        elif value is not None:
            socket.default_value = value
    return made


def out(made: Any) -> Any:
    return next(socket for socket in made.outputs if socket.enabled)


def attribute(tree: Any, name: str, output: str = "Fac") -> Any:
    return node(tree, "Attribute", attribute_name=name).outputs[output]


def options(kind: str, name: str) -> list[str]:
    return [item.identifier for item in getattr(bpy.types, f"ShaderNode{kind}").bl_rna.properties[name].enum_items]


def ramp(tree: Any, place: Any, interpolation: str, mode: str = "RGB", hue: str = "NEAR", stops: Any = ()) -> Any:
    made = node(tree, "ValToRGB", place)
    elements = made.color_ramp.elements
    stops = stops or ((10.0, (0.9, 0.2, 0.1, 1.0)), (60.0, (0.1, 0.3, 0.8, 0.3)), (90.0, (0.2, 0.9, 0.4, 0.6)),
                      (200.0, (0.6, 0.6, 0.1, 0.9)))  # fmt: skip
    while len(elements) < len(stops):
        elements.new(1.0)
    for element, (position, colour) in zip(elements, stops):
        element.position, element.color = position / 255.0, colour
    made.color_ramp.color_mode = mode
    made.color_ramp.interpolation, made.color_ramp.hue_interpolation = interpolation, hue
    return made


def chains() -> dict[str, Build]:
    found: dict[str, Build] = {}

    def add(name: str, build: Build) -> None:
        found[name] = build

    for operation in options("Math", "operation"):
        add(operation, lambda t, a, b, c, o=operation: out(node(t, "Math", a, b, 0.3, operation=o)))
    add("Math, clamped", lambda t, a, b, c: out(node(t, "Math", a, b, use_clamp=True)))
    for how in options("MapRange", "interpolation_type"):
        for clamp in (False, True):
            add(
                f"Map Range {how} {clamp}",
                lambda t, a, b, c, h=how, k=clamp: out(
                    node(t, "MapRange", a, 0.2, 0.8, 1.5, b, 4.0, interpolation_type=h, clamp=k)
                ),
            )
        add(
            f"Map Range {how}, of vectors",
            lambda t, a, b, c, h=how: out(
                node(t, "MapRange", c, (0.1, 0.2, 0.3), (0.93, 0.71, 0.52), (0.0, 0.5, 1.0), (1.0, 0.2, 0.3),
                     (3.0, 4.0, 5.0), data_type="FLOAT_VECTOR", interpolation_type=h)
            ),
        )  # fmt: skip
    add("Map Range, backwards", lambda t, a, b, c: out(
        node(t, "MapRange", a, 0.8, 0.2, 0.0, 1.0, interpolation_type="SMOOTHSTEP")))  # fmt: skip
    for how in options("Clamp", "clamp_type"):
        add(f"Clamp {how}", lambda t, a, b, c, h=how: out(node(t, "Clamp", a, 0.6, b, clamp_type=h)))
    for mode in options("MixRGB", "blend_type"):
        other = (0.2, 0.5, 0.9, 1.0)
        add(f"Mix {mode}", lambda t, a, b, c, m=mode, o=other: out(
            node(t, "Mix", b, c, o, data_type="RGBA", blend_type=m, clamp_result=True)))  # fmt: skip
        add(f"MixRGB {mode}", lambda t, a, b, c, m=mode, o=other: out(node(t, "MixRGB", 0.7, o, c, blend_type=m)))
    add("Mix, of numbers", lambda t, a, b, c: out(node(t, "Mix", a, b, 0.3, clamp_factor=False)))
    add("Mix, of vectors", lambda t, a, b, c: out(
        node(t, "Mix", a, c, (0.1, 0.5, 0.9), data_type="VECTOR")))  # fmt: skip
    add("Mix, part by part", lambda t, a, b, c: out(
        node(t, "Mix", c, (0.3, 0.2, 0.1), (0.1, 0.5, 0.9), data_type="VECTOR", factor_mode="NON_UNIFORM")))  # fmt: skip
    for mode in options("SeparateColor", "mode"):
        for part in range(3):
            add(f"Separate {mode} {part}", lambda t, a, b, c, m=mode, p=part: node(
                t, "SeparateColor", c, mode=m).outputs[p])  # fmt: skip
        add(f"Combine {mode}", lambda t, a, b, c, m=mode: out(node(t, "CombineColor", a, b, 0.6, mode=m)))
    for kind, parts in (("XYZ", "X Y Z"), ("RGB", "R G B"), ("HSV", "H S V")):
        if hasattr(bpy.types, f"ShaderNodeSeparate{kind}"):
            for part in range(len(parts.split())):
                add(f"Separate{kind} {part}", lambda t, a, b, c, k=kind, p=part: node(
                    t, f"Separate{k}", c).outputs[p])  # fmt: skip
            add(f"Combine{kind}", lambda t, a, b, c, k=kind: out(node(t, f"Combine{k}", a, b, 0.4)))
    add("Invert", lambda t, a, b, c: out(node(t, "Invert", b, c)))
    add("Gamma", lambda t, a, b, c: out(node(t, "Gamma", c, 2.2)))
    add("Bright/Contrast", lambda t, a, b, c: out(node(t, "BrightContrast", c, b, 0.5)))
    add("Hue/Saturation", lambda t, a, b, c: out(node(t, "HueSaturation", 0.7, 1.5, 0.8, b, c)))
    add("RGB to BW", lambda t, a, b, c: out(node(t, "RGBToBW", c)))
    add("a color as a number", lambda t, a, b, c: out(node(t, "Math", c, 1.0, operation="MULTIPLY")))
    add("a vector as a number", lambda t, a, b, c: out(
        node(t, "Math", attribute(t, "tone", "Vector"), 1.0, operation="MULTIPLY")))  # fmt: skip
    add("Blackbody", lambda t, a, b, c: out(
        node(t, "Gamma", out(node(t, "Blackbody", out(node(t, "Math", a, 4000.0, operation="MULTIPLY")))), 1.0)))  # fmt: skip
    for interpolation in ("EASE", "CARDINAL", "LINEAR", "B_SPLINE", "CONSTANT"):
        add(f"ColorRamp {interpolation}", lambda t, a, b, c, i=interpolation: ramp(t, a, i).outputs[0])
    add("ColorRamp's alpha", lambda t, a, b, c: ramp(t, a, "LINEAR").outputs[1])
    for mode in ("HSV", "HSL"):
        for hue in ("NEAR", "FAR", "CW", "CCW"):
            add(f"ColorRamp {mode} {hue}", lambda t, a, b, c, m=mode, h=hue: ramp(t, a, "LINEAR", m, h).outputs[0])
    add("ColorRamp of coincident stops", lambda t, a, b, c: ramp(t, a, "LINEAR", stops=(
        (0.0, (0.0, 0.3, 0.0, 1.0)), (100.0, (0.2, 0.2, 0.2, 1.0)), (100.0, (0.8, 0.1, 0.2, 1.0)),
        (255.0, (0.1, 0.1, 0.9, 1.0)))).outputs[0])  # fmt: skip
    add("ColorRamp of one stop", lambda t, a, b, c: one_stop(t, a))
    add("Value", lambda t, a, b, c: set_output(node(t, "Value"), 0.37))
    add("RGB", lambda t, a, b, c: set_output(node(t, "RGB"), (0.1, 0.5, 0.3, 1.0)))
    add("Attribute's vector", lambda t, a, b, c: attribute(t, "tone", "Vector"))
    add("an attribute that is not there", lambda t, a, b, c: out(node(t, "Math", attribute(t, "absent"), 0.25)))
    add("muted", lambda t, a, b, c: muted(node(t, "Math", b, 3.0, operation="MULTIPLY")))
    add("muted, without a link", lambda t, a, b, c: muted(node(t, "Math", 0.4, 0.5, operation="MULTIPLY")))
    add("muted, nothing goes through", lambda t, a, b, c: out(node(t, "Math", muted(node(t, "Value")), 0.1)))
    add("reroutes", lambda t, a, b, c: out(node(t, "Gamma", rerouted(t, rerouted(t, c)), 1.5)))
    add("a group in a group", grouped)
    return found


def one_stop(tree: Any, place: Any) -> Any:
    made = ramp(tree, place, "EASE")
    while len(made.color_ramp.elements) > 1:
        made.color_ramp.elements.remove(made.color_ramp.elements[-1])
    return made.outputs[0]


def set_output(made: Any, value: Any) -> Any:
    made.outputs[0].default_value = value
    return made.outputs[0]


def muted(made: Any) -> Any:
    made.mute = True
    return made.outputs[0]


def rerouted(tree: Any, socket: Any) -> Any:
    made = tree.nodes.new("NodeReroute")
    tree.links.new(socket, made.inputs[0])
    return made.outputs[0]


def group(build: Callable[[Any, Any, Any], Any]) -> Any:
    """A group of a linked and an unlinked number."""
    tree = bpy.data.node_groups.new("Group", "ShaderNodeTree")
    for direction, kind, name in (
        ("INPUT", "NodeSocketFloat", "Linked"),
        ("INPUT", "NodeSocketFloat", "Unlinked"),
        ("OUTPUT", "NodeSocketColor", "Result"),
    ):
        if hasattr(tree, "interface"):
            tree.interface.new_socket(name, in_out=direction, socket_type=kind)
        else:
            (tree.inputs if direction == "INPUT" else tree.outputs).new(kind, name)
    begin, end = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    tree.links.new(build(tree, begin.outputs[0], begin.outputs[1]), end.inputs[0])
    return tree


def grouped(tree: Any, a: Any, b: Any, _: Any) -> Any:
    """Two of the same group with other values, in a group."""
    inner = group(lambda t, linked, unlinked: out(node(t, "Math", linked, unlinked, operation="MULTIPLY")))

    def both(t: Any, linked: Any, unlinked: Any) -> Any:
        made = [node(t, "Group", node_tree=inner) for _ in range(2)]
        for number, one in enumerate(made):
            t.links.new(linked, one.inputs[0])
            one.inputs[1].default_value = 0.5 + number
        t.links.new(unlinked, made[1].inputs[1])
        return out(node(t, "Mix", 0.25, made[0].outputs[0], made[1].outputs[0], data_type="RGBA"))

    outer = node(tree, "Group", node_tree=group(both))
    tree.links.new(a, outer.inputs[0])
    outer.inputs[1].default_value = 0.8
    return outer.outputs[0]


def test_nodes_calculate_what_those_of_cycles_do() -> None:
    """Each chain is what a row of squares emits, of a mesh that has the numbers as attributes."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    tone = np.stack((VALUES, OTHERS, (VALUES * 1.7) % 1.0), axis=1)
    built, count = chains(), len(VALUES)
    shape = len(built), count
    corners = np.stack(np.meshgrid(np.arange(count + 1), np.arange(shape[0] + 1)), axis=-1).reshape(-1, 2)
    first = (np.arange(shape[0])[:, None] * (count + 1) + np.arange(count)).reshape(-1, 1)
    mesh = bpy.data.meshes.new("Chains")
    mesh.from_pydata([(x, y, 0) for x, y in corners.tolist()], [], (first + (0, 1, count + 2, count + 1)).tolist())
    for name, kind, values in (("one", "FLOAT", VALUES), ("two", "FLOAT", OTHERS), ("tone", "FLOAT_VECTOR", tone)):
        made = mesh.attributes.new(name, kind, "FACE")
        made.data.foreach_set("vector" if kind == "FLOAT_VECTOR" else "value", np.tile(values.T, shape[0]).T.ravel()
                              if values.ndim == 1 else np.tile(values, (shape[0], 1)).ravel())  # fmt: skip
    mesh.polygons.foreach_set("material_index", np.repeat(np.arange(shape[0]), count))
    thing = bpy.data.objects.new("Chains", mesh)
    view = bpy.context.scene
    view.collection.objects.link(thing)
    shaders = []
    for name, build in built.items():
        shader = harness.shade(mesh, "ShaderNodeEmission")
        tree = shader.id_data
        sockets = [attribute(tree, "one"), attribute(tree, "two"), attribute(tree, "tone", "Color")]
        tree.links.new(build(tree, *sockets), shader.inputs["Color"])
        shaders.append(shader)
    camera = bpy.data.cameras.new("Camera")
    camera.type, camera.ortho_scale = "ORTHO", float(max(shape))
    view.camera = bpy.data.objects.new("Camera", camera)
    view.camera.location = (count / 2.0, shape[0] / 2.0, 5.0)
    view.collection.objects.link(view.camera)
    view.world = harness.black_world()
    view.render.resolution_percentage, view.render.filter_size = 100, 0.01
    view.cycles.samples, view.cycles.pixel_filter_type, view.cycles.filter_width = 1, "BOX", 0.01
    view.cycles.use_adaptive_sampling = view.cycles.use_denoising = False
    theirs = pictures.render((count, shape[0]), "CYCLES")[..., :3]
    grids = {"one": VALUES, "two": OTHERS, "tone": tone}
    wrong = []
    for name, shader, row in zip(built, shaders, theirs):
        notices: list[str] = []
        field = reading.Reader("Chains", notices).value(reading.Place(shader), "Color")
        ours = np.broadcast_to(fields.evaluate([field], grids)[0], row.shape)
        shown = np.isfinite(row) & (np.abs(row) < 1e4)
        error = np.where(shown, np.abs(ours - row) / np.maximum(np.abs(row).max(axis=1, keepdims=True), 0.1), 0.0).max(axis=1)
        worst = int(error.argmax())
        if notices or not error[worst] < 2e-3:
            wrong.append(f"{name}: {error[worst]:.2g} at {VALUES[worst]:.3f}, {tone[worst]}: {ours[worst]}, {row[worst]} {notices}")
    print(f"  {len(built)} chains")
    assert not wrong, "\n".join(wrong)


harness.main()
