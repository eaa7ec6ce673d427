#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Usage: findings/random_of_objects.sh
#
# What an exporter can know of Object Info's Random (bpy 4.5.15 and 5.0.1 from PyPI). A depsgraph's instances have a
# random_id, of which Cycles' Random is the share of 2^32 - 1 for what is instanced. For an object that stands in the scene
# by itself random_id is 0, though, while Cycles shows a number that depends on its name alone: its bytes are the digits of
# a number to the base of 37, which the last rounds of Bob Jenkins' lookup3 mix. So renaming an object gives it another
# color, and a copy of an exporter that trusts random_id gives all objects the same one.
#
# Seen, in both:
#   Grid: random_id 0, Random .1883; Foo: random_id 0, Random .6115
#
# Fails if that changes.

set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cat >"$folder/names.py" <<'PYTHON'
import bpy
import numpy as np

BITS = 0xFFFFFFFF


def mixed(name):
    number = 0
    for byte in name.encode():
        number = (37 * number + byte) & BITS
    turned = lambda x, by: (x << by | x >> (32 - by)) & BITS
    a = b = c = 0xDEADBEEF + 21
    a = (a + number) & BITS
    rounds = ("c", "b", 14), ("a", "c", 11), ("b", "a", 25), ("c", "b", 16), ("a", "c", 4), ("b", "a", 14), ("c", "b", 24)
    for first, second, by in rounds:
        values = {"a": a, "b": b, "c": c}
        values[first] = ((values[first] ^ values[second]) - turned(values[second], by)) & BITS
        a, b, c = values["a"], values["b"], values["c"]
    return c / BITS


def seen(name):
    """The depsgraph's random_id of an object, and what Cycles shows as its Random."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("World")
    mesh = bpy.data.meshes.new("Mesh")
    mesh.from_pydata([(-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)], [], [(0, 1, 2, 3)])
    thing = bpy.data.objects.new(name, mesh)
    scene.collection.objects.link(thing)
    material = bpy.data.materials.new("Material")
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    info, glow, output = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("ObjectInfo", "Emission", "OutputMaterial"))
    tree.links.new(info.outputs["Random"], glow.inputs["Color"])
    tree.links.new(glow.outputs[0], output.inputs["Surface"])
    mesh.materials.append(material)
    camera = bpy.data.cameras.new("Camera")
    scene.camera = bpy.data.objects.new("Camera", camera)
    scene.camera.location = (0.0, 0.0, 5.0)
    scene.collection.objects.link(scene.camera)
    render = scene.render
    render.engine, render.resolution_x, render.resolution_y = "CYCLES", 4, 4
    scene.cycles.samples, scene.cycles.use_denoising = 1, False
    render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
    render.filepath = f"{bpy.app.tempdir}seen.exr"
    bpy.ops.render.render(write_still=True)
    picture = bpy.data.images.load(render.filepath)
    instances = bpy.context.evaluated_depsgraph_get().object_instances
    number = next(each.random_id for each in instances if each.object.name == name)
    return number, float(np.array(picture.pixels[:]).reshape(-1, 4)[:, 0].mean())


for name in ("Grid", "Foo"):
    number, shown = seen(name)
    print(f"{bpy.app.version_string} {name}: random_id {number}, Random {shown:.4f}, by its name {mixed(name):.4f}")
    assert number == 0
    assert abs(shown - mixed(name)) < 1e-3
PYTHON
for version in 4.5.15 5.0.1; do
    python3.11 -m venv "$folder/$version"
    "$folder/$version/bin/pip" install --quiet "bpy==$version" 'numpy<2'
    "$folder/$version/bin/python" "$folder/names.py"
done
