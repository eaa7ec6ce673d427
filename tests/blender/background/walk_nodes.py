# SPDX-License-Identifier: GPL-3.0-or-later
"""A walk through Blender's shader nodes, their inputs and properties: each is in the tables of addon/export/known, and what
is not followed is named where it is used."""

from typing import Any

import bpy
import harness
import pictures
from sfumato.export.known import Node, nodes
from stage import Stage


def node_classes() -> list[str]:
    names = [name for name in dir(bpy.types) if name.startswith("ShaderNode")]
    kinds = [getattr(bpy.types, name) for name in names]
    return [name for name, kind in zip(names, kinds) if issubclass(kind, bpy.types.ShaderNode)]


def test_every_shader_node_is_in_a_table_once() -> None:
    known = [node.name for node in nodes.FOLLOWED]
    known += [f"ShaderNode{name}" for names in nodes.OTHERS.values() for name in names.split()]
    there = set(node_classes()) - {"ShaderNode", "ShaderNodeTree", "ShaderNodeCustomGroup"}
    assert len(there) > 80
    assert not there - set(known), sorted(there - set(known))
    assert len(known) == len(set(known)), sorted(name for name in known if known.count(name) > 1)


def test_every_input_and_property_of_followed_nodes_is_in_a_table_once() -> None:
    tree = bpy.data.node_groups.new("Tree", "ShaderNodeTree")
    wrong = []
    for table in nodes.FOLLOWED:
        if not hasattr(bpy.types, table.name):
            continue
        node = tree.nodes.new(table.name)
        base = {prop.identifier for prop in bpy.types.ShaderNode.bl_rna.properties}
        own = {socket.name for socket in node.inputs}
        own |= {prop.identifier for prop in node.bl_rna.properties if prop.identifier not in base}
        wrong += [f"{table.name}: {name} is in no table" for name in sorted(own - set(inputs_of(table)))]
        twice = {name for name in inputs_of(table) if inputs_of(table).count(name) > 1}
        links_alone = {socket.name for socket in table.named if not socket.neutral}  # the value is followed
        wrong += [f"{table.name}: {name} is there twice" for name in twice - links_alone]
    assert not wrong, "\n".join(wrong)


def inputs_of(table: Node) -> list[str]:
    idle = [name for names in table.idle.values() for name in names]
    return [*table.followed, *{socket.name for socket in table.named}, *table.elsewhere, *idle]


def with_node(name: str) -> tuple[Stage, Any, str]:
    """A stage on which a followed node does its work, and whose it is."""
    stage = Stage()
    if name == "ShaderNodeVolumePrincipled":
        return stage, stage.smoke_shader, "Smoke"
    if "Volume" in name:
        tree = stage.smoke_shader.id_data
        shader = tree.nodes.new(name)
        tree.links.new(shader.outputs[0], tree.nodes["Material Output"].inputs["Volume"])
        return stage, shader, "Smoke"
    if "Output" in name or name == "ShaderNodeBackground":
        owner = {"ShaderNodeOutputWorld": stage.scene.world, "ShaderNodeBackground": stage.scene.world}.get(
            name, stage.floor.data.materials[0]
        )
        found = next(node for node in owner.node_tree.nodes if node.bl_idname == name)
        return stage, found, "World" if owner == stage.scene.world else "Floor"
    owner = stage.floor
    if name == "ShaderNodeBsdfHairPrincipled":
        owner = stage.add("Hair", stage.floor.data.copy())
        hair = owner.modifiers.new("Hair", "PARTICLE_SYSTEM").particle_system.settings
        hair.type, hair.count = "HAIR", 4
        owner.data.materials[0] = owner.data.materials[0].copy()
    tree = owner.data.materials[0].node_tree
    shader = tree.nodes.new(name)
    tree.links.new(shader.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    return stage, shader, owner.name


def link_unknown(node: Any, socket: Any) -> None:
    """Into a socket comes what no export can know."""
    tree = node.id_data
    volume = socket.type == "SHADER"
    source = tree.nodes.new("ShaderNodeVolumeScatter" if volume else "ShaderNodeAmbientOcclusion")
    tree.links.new(source.outputs[0], socket)


# Without which others mean nothing.
NEEDS = {"Anisotropic Rotation": "Anisotropic", "Rotation": "Anisotropy", "Coat Roughness": "Coat Weight",
         "Coat IOR": "Coat Weight", "Emission Color": "Emission Strength", "Blackbody Tint": "Blackbody Intensity",
         "Temperature": "Blackbody Intensity", "IOR": "Transmission", "Clearcoat Roughness": "Clearcoat",
         "Coat Tint": "Coat Weight", "Sheen Roughness": "Sheen Weight", "Random": "Random Roughness",
         "Sheen Tint": "Sheen" if bpy.app.version < (4, 0, 0) else "Sheen Weight"}  # fmt: skip


def test_inputs_of_followed_nodes_that_are_not_followed_are_named() -> None:
    """Their values and what is linked to them; of those that are followed, links."""
    wrong: list[str] = []
    for table in nodes.FOLLOWED:
        if not hasattr(bpy.types, table.name) or table.name in {
            "ShaderNodeOutputLight",
            "ShaderNodeRGB",
            "ShaderNodeValue",
        }:
            continue
        stage, node, owner = with_node(table.name)
        for socket in table.named:
            if socket.name not in node.inputs or not node.inputs[socket.name].enabled:
                continue
            stage, node, owner = with_node(table.name)
            if socket.unless is not None:
                node.inputs[socket.unless[0]].default_value = 0.5
            before = stage.exported()
            found = node.inputs[socket.name]
            if socket.neutral:
                kept = found.default_value
                if isinstance(kept, bool):
                    found.default_value, value = True, ""
                elif isinstance(kept, float):
                    found.default_value, value = 0.375, "0.375"
                else:
                    kept, value = tuple(kept), "0.375"
                    found.default_value = (0.375, 0.5, 0.625, 1.0)
                wrong.append(stage.not_heard_once(before, f"{owner}: ", node.bl_rna.name, socket.name, value))
                found.default_value = kept
            link_unknown(node, found)
            wrong.append(stage.not_heard_once(before, f"{owner}: ", socket.name, "link"))
        for name in table.followed:
            if (
                name in node.inputs
                and node.inputs[name].type in {"RGBA", "VALUE"}
                and name not in {socket.name for socket in table.named}
            ):
                stage, node, owner = with_node(table.name)
                if name in NEEDS and NEEDS[name] in node.inputs:
                    node.inputs[NEEDS[name]].default_value = 0.5
                if hasattr(node, "parametrization"):
                    node.parametrization = "COLOR" if name == "Color" else "MELANIN"
                before = stage.exported()
                link_unknown(node, node.inputs[name])
                wrong.append(stage.not_heard_once(before, f"{owner}: ", name, "link"))
    assert not any(wrong), "\n".join(filter(None, wrong))


def test_nodes_that_are_not_followed_are_named_where_they_are_used() -> None:
    wrong: list[str] = []
    cases = {
        nodes.SURFACES: ("Floor", "Surface"),
        "Holdout": ("Smoke", "Volume"),
        nodes.IN_VOLUMES: ("Floor", "Base Color"),
        nodes.IN_WORLDS: ("Floor", "Base Color"),
        nodes.ON_SURFACES: ("Smoke", "Color"),
        nodes.OUTSIDE_VOLUMES: ("Smoke", "Color"),
        nodes.VALUES: ("Floor", "Base Color"),
    }
    for names, (owner, into) in cases.items():
        stage = Stage()
        shader = stage.smoke_shader if owner == "Smoke" else stage.floor_shader
        tree = shader.id_data
        own = into in {"Base Color", "Color"}
        socket = (shader if own else tree.nodes["Material Output"]).inputs[into]
        source = socket.links[0].from_socket if socket.is_linked else None
        before = stage.exported()
        for name in names.split():
            # A Script has the outputs of its script.
            if name == "Script" or not hasattr(bpy.types, f"ShaderNode{name}"):
                continue
            node = tree.nodes.new(f"ShaderNode{name}")
            if name == "Group":
                node.node_tree = group()
            tree.links.new(node.outputs[0], socket)
            wrong.append(stage.not_heard_once(before, f"{owner}: ", into if own else "shown"))
            tree.nodes.remove(node)
            if source is not None:
                tree.links.new(source, socket)
    assert not any(wrong), "\n".join(filter(None, wrong))


def test_a_muted_shader_is_black_as_in_cycles() -> None:
    for name in ("ShaderNodeBsdfDiffuse", "ShaderNodeBsdfPrincipled", "ShaderNodeEmission", "ShaderNodeBackground"):
        stage, node, _ = with_node(name)
        stage.smoke.hide_render = stage.glow.hide_render = True
        stage.floor.hide_render = name == "ShaderNodeBackground"
        for other in stage.scene.world.node_tree.nodes:
            other.mute = other.type == "BACKGROUND"
        node.mute = True
        stage.scene.cycles.samples, stage.scene.cycles.use_denoising = 1, False
        assert pictures.render(None, "CYCLES")[..., :3].max() == 0.0, name
        assert pictures.render()[..., :3].max() == 0.0, name


def group() -> bpy.types.NodeTree:
    """A node group of one surface."""
    tree = bpy.data.node_groups.new("Group", "ShaderNodeTree")
    if hasattr(tree, "interface"):
        tree.interface.new_socket("Surface", in_out="OUTPUT", socket_type="NodeSocketShader")
    else:
        tree.outputs.new("NodeSocketShader", "Surface")
    shader, output = tree.nodes.new("ShaderNodeBsdfDiffuse"), tree.nodes.new("NodeGroupOutput")
    tree.links.new(shader.outputs[0], output.inputs[0])
    return tree


harness.main()
