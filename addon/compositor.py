# SPDX-License-Identifier: GPL-3.0-or-later
"""The smoke of a scene that another engine renders: a second scene has it from us, and the compositor joins both."""

from __future__ import annotations

from typing import Any

import bpy

from . import compat, passes, props
from .export import smoke

# Nodes are found again by these names.
HOME = "sfumato_smoke"  # the mark of the collection that the smoke moves to
SMOKE, SHADOW, OVER = "Sfumato Smoke", "Sfumato Smoke Shadow", "Sfumato Smoke Over"
# What both scenes must have in common, and the artist may have changed since the second one was made.
SHARED = ("camera", "world", "frame_start", "frame_end", "frame_step", "gravity", "use_gravity")
SHARED_RENDER = ("fps", "fps_base", "pixel_aspect_x", "pixel_aspect_y", "resolution_x", "resolution_y",
                 "resolution_percentage", "use_simplify", "simplify_volumes", "simplify_subdivision_render")  # fmt: skip


def smoke_objects(scene: Any) -> list[Any]:
    """The objects of a scene that are smoke."""
    return [thing for thing in scene.objects if thing.type == "VOLUME" or smoke.domain_settings(thing)]


def add_smoke(scene: Any, view_layer: Any) -> Any:
    """Have `scene`, of another engine, show its smoke by ours: the other scene, which is made or brought up to date.

    Its smoke moves to a collection of its own, which the scene's own view layers leave out.
    """
    other = props.of(scene).smoke_scene or _copy_of(scene, view_layer)
    _share(scene, other)
    _move_smoke(scene, other)
    _join(scene, view_layer, other)
    return other


def _copy_of(scene: Any, view_layer: Any) -> Any:
    other = scene.copy()
    other.name = f"{scene.name} Smoke"
    props.of(scene).smoke_scene, props.of(other).smoke_scene = other, None
    compat.remove_compositing(other)
    other.sequence_editor_clear()
    for layer in list(other.view_layers):
        if layer.name != view_layer.name:
            other.view_layers.remove(layer)
        else:
            layer.use_sky = False  # a volume of the world is in the other engine's own picture
    other.render.engine = "SFUMATO"
    other.render.film_transparent = True
    asked = passes.of(other.view_layers[0])
    asked.smoke = asked.smoke_shadow = True
    return other


def _share(scene: Any, other: Any) -> None:
    for owner, twin, names in ((scene, other, SHARED), (scene.render, other.render, SHARED_RENDER)):
        for name in names:
            setattr(twin, name, getattr(owner, name))
    for thing in scene.collection.objects:
        if thing.name not in other.collection.objects:
            other.collection.objects.link(thing)
    for child in scene.collection.children:
        if child.name not in other.collection.children:
            other.collection.children.link(child)


def _move_smoke(scene: Any, other: Any) -> None:
    # By a mark: its name may be another one's already, or be cut.
    home = next((child for child in scene.collection.children if child.get(HOME)), None)
    if home is None:
        home = bpy.data.collections.new(f"{scene.name} Smoke")
        home[HOME] = True
        scene.collection.children.link(home)
        other.collection.children.link(home)
    ours = {scene.collection, other.collection, *scene.collection.children_recursive}
    for thing in smoke_objects(scene):
        if thing.name not in home.objects:
            home.objects.link(thing)
        for collection in thing.users_collection:
            if collection != home and collection in ours:
                collection.objects.unlink(thing)
    for layer in scene.view_layers:
        layer.layer_collection.children[home.name].exclude = True
    for layer in other.view_layers:
        layer.layer_collection.children[home.name].exclude = False


def _join(scene: Any, view_layer: Any, other: Any) -> None:
    """The picture that leaves the scene's own Render Layers, times the shadow, and the smoke over it, goes wherever that
    picture went."""
    tree = compat.compositing_tree(scene)
    picture = _render_layers(tree, scene, view_layer)
    nodes, links = tree.nodes, tree.links
    found = nodes.get(SMOKE)
    ours = found or nodes.new("CompositorNodeRLayers")
    ours.name = ours.label = SMOKE
    ours.scene, ours.layer = other, other.view_layers[0].name
    if SHADOW in nodes and OVER in nodes:
        if found is None:  # the artist deleted that one alone
            links.new(ours.outputs["Smoke Shadow"], compat.colour_inputs(nodes[SHADOW])[1])
            links.new(ours.outputs["Smoke"], compat.colour_inputs(nodes[OVER])[1])
        return
    follow = [link.to_socket for link in picture.outputs["Image"].links]
    shadow, (base, factor), shaded = compat.multiply_node(tree)
    shadow.name = shadow.label = SHADOW
    over, (behind, before) = compat.over_node(tree)
    over.name = over.label = OVER
    x, y = picture.location
    ours.location, shadow.location, over.location = (x, y - 420.0), (x + 320.0, y), (x + 520.0, y)
    for node in {socket.node for socket in follow}:
        node.location.x += 440.0
    links.new(picture.outputs["Image"], base)
    links.new(ours.outputs["Smoke Shadow"], factor)
    links.new(shaded, behind)
    links.new(ours.outputs["Smoke"], before)
    for socket in follow:
        links.new(over.outputs[0], socket)
    if not follow:
        links.new(over.outputs[0], compat.compositing_output(tree))


def _render_layers(tree: Any, scene: Any, view_layer: Any) -> Any:
    """The node through which a view layer's picture comes: that which leads somewhere first."""
    found = [node for node in tree.nodes if node.type == "R_LAYERS" and node.scene == scene and node.name != SMOKE]
    found.sort(key=lambda node: (node.layer != view_layer.name, not node.outputs["Image"].is_linked))
    if found:
        return found[0]
    node = tree.nodes.new("CompositorNodeRLayers")
    node.scene, node.layer = scene, view_layer.name
    return node
