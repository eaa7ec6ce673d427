# SPDX-License-Identifier: GPL-3.0-or-later
"""What differs between Blender 3.4 and 5.3, by capability rather than by version wherever one can be asked for. A version
that is asked for is named with the two between which it was seen to change, and the case that shows it: of
tests/blender/background/light_power.py for lamps, materials.py for materials, where nothing else is said."""

from __future__ import annotations

import math
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray


def set_pixels(layer: Any, views: list[dict[str, NDArray[np.float32]]]) -> None:
    """Fill all passes of a render layer: of each view (height, width, channels) pixels by the pass's name."""
    # `rect` itself takes Python lists only before 4.0, at 90 ms for 640 x 360; its collection takes a buffer of all.
    flat = [np.ascontiguousarray(views[one.view_id][one.name], dtype=np.float32).reshape(-1) for one in layer.passes]
    layer.passes.foreach_set("rect", np.concatenate(flat))


def index_pass(of: str) -> str:
    """The name of the pass of an Object's or a Material's index. 4.5.15 against 5.0.1: passes.py."""
    return f"{of} Index" if bpy.app.version >= (5, 0, 0) else {"Object": "IndexOB", "Material": "IndexMA"}[of]


def normals(mesh: Any, own_copy: bool) -> NDArray[np.float32] | None:
    """Normals of a mesh whose loop triangles are calculated: of its vertices (n, 3), of the corners of its triangles
    (m, 3, 3), or None where its triangles are flat. `own_copy`: whether the mesh may be changed for it."""
    domain = getattr(mesh, "normals_domain", None)  # 4.1
    if domain is None:
        smooth = np.empty(len(mesh.polygons), dtype=bool)
        mesh.polygons.foreach_get("use_smooth", smooth)
        if own_copy and corner_normals_need_a_copy(mesh):
            domain = "CORNER"
        else:
            domain = "POINT" if smooth.all() else "MIXED" if smooth.any() else "FACE"
    count = len(mesh.loop_triangles)
    if domain == "FACE" and len(mesh.polygons) == count:
        return None
    if domain == "POINT":
        of_vertices = np.empty(len(mesh.vertices) * 3, dtype=np.float32)
        mesh.vertex_normals.foreach_get("vector", of_vertices)
        return of_vertices.reshape(-1, 3)
    if hasattr(mesh, "calc_normals_split") and own_copy:  # gone in 4.1, where they are always there
        mesh.calc_normals_split()
    if domain == "CORNER":
        of_corners = np.empty(count * 9, dtype=np.float32)
        mesh.loop_triangles.foreach_get("split_normals", of_corners)
        return of_corners.reshape(-1, 3, 3)
    polygon = np.empty(count, dtype=np.int32)
    mesh.loop_triangles.foreach_get("polygon_index", polygon)
    of_polygons = np.empty(len(mesh.polygons) * 3, dtype=np.float32)
    mesh.polygons.foreach_get("normal", of_polygons)
    flat = np.repeat(of_polygons.reshape(-1, 3)[polygon][:, None], 3, axis=1)
    if domain == "FACE":
        return flat
    corners = np.empty(count * 3, dtype=np.int32)
    mesh.loop_triangles.foreach_get("vertices", corners)
    of_vertices = np.empty(len(mesh.vertices) * 3, dtype=np.float32)
    mesh.vertex_normals.foreach_get("vector", of_vertices)
    return np.where(smooth[polygon][:, None, None], of_vertices.reshape(-1, 3)[corners.reshape(-1, 3)], flat)


def corner_normals_need_a_copy(mesh: Any) -> bool:
    """Whether asking for the normals of a mesh's corners would change the mesh: before 4.1, where they are calculated
    on demand, and smooth shading ends at an angle or normals are an artist's own."""
    return hasattr(mesh, "calc_normals_split") and bool(mesh.use_auto_smooth)


def subdivides_on_the_gpu(thing: Any) -> bool:
    """Whether an evaluated object's data may be coarser than what Blender draws: since 3.1 the last subdivision is
    left to the GPU where there is one, until somebody asks for a copy of the mesh."""
    return not bpy.app.background and any(modifier.type == "SUBSURF" for modifier in thing.modifiers)


def instance_matrices(depsgraph: Any) -> tuple[NDArray[np.bool_], NDArray[np.bool_], NDArray[np.float64]]:
    """Of each of the depsgraph's object instances, whether it is shown itself, (n,), whether its particles are, (n,), and
    its matrix, (n, 4, 4)."""
    # One by one: before 5.0 foreach_get loses 250 bytes for each instance of particles at each call
    # (findings/instances_read_in_bulk.sh), and it is no faster.
    shown: list[bool] = []
    emits: list[bool] = []
    numbers: list[float] = []
    for instance in depsgraph.object_instances:
        shown.append(instance.show_self)
        emits.append(instance.show_particles)
        first, second, third, last = instance.matrix_world
        numbers += (*first, *second, *third, *last)
    return np.array(shown, bool), np.array(emits, bool), np.array(numbers, np.float64).reshape(-1, 4, 4)


def light_colour(light: Any) -> NDArray[np.float64]:
    """Colour times strength of a light, in its own unit."""
    colour: NDArray[np.float64] = np.array(light.color, dtype=np.float64) * light.energy
    if hasattr(light, "exposure"):  # 4.5
        colour = colour * 2.0**light.exposure
    if getattr(light, "use_temperature", False):
        colour = colour * np.array(light.temperature_color)
    return colour


def casts_shadow(light: Any) -> bool:
    """Cycles' own switch before 4.2, where Blender's became it."""
    old = getattr(getattr(light, "cycles", None), "cast_shadow", None)
    return bool(light.use_shadow if old is None else old)


def sample_place() -> float:
    """Where in its cell, counted from the lattice point that OpenVDB gives it, Cycles shows a sample of a Volume object's
    file: in the middle, as Mantaflow means it, or from 5.0 on where OpenVDB has it. volumes.py: half a cell higher in 4.5.15
    than in 5.0.1."""
    return 0.0 if bpy.app.version >= (5, 0, 0) else 0.5


def voxels_emit() -> bool:
    """Whether Cycles takes what is between two voxels for a mixture of what they emit, as from 5.0 on, where it looks up
    one of them at random; and not for what the mixture of their values emits, which is less. fire.py: a black body's fire
    gives 1.17 times the light in 5.0.1 that it gives in 4.5.15."""
    return bool(bpy.app.version >= (5, 0, 0))


def constants_fill_more() -> bool:
    """Whether Cycles lets what emits the same everywhere fill more than the blocks that hold smoke. fire.py: 9 % of the
    light in 5.0.1, none in 4.5.15."""
    return bool(bpy.app.version >= (5, 0, 0))


def mixes_emission() -> bool:
    """Whether a Mix Shader shares out what volume shaders emit, rather than what they scatter and absorb alone. 4.2.23
    against 4.5.15: findings/volume_shaders_added.sh; all of the emission, a quarter."""
    return bool(bpy.app.version >= (4, 5, 0))


def muted_links_are_dropped() -> bool:
    """Whether what is linked to a muted node, through which nothing comes, keeps its own value, rather than having 0. 4.5.15
    against 5.0.1: volume_nodes.py, 'muted, without a link'."""
    return bool(bpy.app.version >= (5, 0, 0))


def phases_share_light() -> bool:
    """Whether several shaders that scatter in a volume do not each scatter what is the share of all. 4.2.23 against 4.5.15:
    findings/volume_shaders_added.sh; two of .05 give twice the light of one of .1, the same light."""
    return bool(bpy.app.version >= (4, 5, 0))


def poly_curves_have_corners() -> bool:
    """Whether hair curves of the type Poly are straight between their points, rather than smooth as all are before. 4.5.15
    against 5.0.1: hair.py."""
    return bool(bpy.app.version >= (5, 0, 0))


def size_factor(light: Any, area: float = 0.0) -> float:
    """What Cycles multiplies a light by where 'Normalize' is off, as it can be from 4.5 on: the area over which it would
    else spread its strength. `area` is that of an area light, scaled; those of points and suns know no scale."""
    if getattr(light, "normalize", True):
        return 1.0
    if light.type == "AREA":
        return area
    if light.type == "SUN":
        sine = math.sin(0.5 * light.angle)
        return math.pi * sine * sine if sine > 0.0 else 1.0
    # A point without a radius counts as 4, so that what is left of its 1 / 4 pi is 1 / pi.
    radius = float(light.shadow_soft_size)
    return 4.0 * math.pi * radius * radius if radius > 0.0 else 4.0


def sun_share(light: Any) -> float:
    """The share of a sun's strength that Cycles sends: before 4.0 wide ones send less. 'widest sun': .904 of 'sun' in
    3.4.1, all of it in 4.2.23."""
    cosine = math.cos(0.5 * light.angle)
    return 2.0 * cosine / (1.0 + cosine) if bpy.app.version < (4, 0, 0) else 1.0


def radiance_of_watts(area: float) -> float:
    """What Cycles makes of each watt of an area light: what sends one watt, or before 4.0 pi / 4 of that. 'rectangle':
    .1382 in 3.4.1, .1759 in 4.2.23."""
    return 1.0 / ((4.0 if bpy.app.version < (4, 0, 0) else math.pi) * area)


def point_light_habits(light: Any) -> dict[str, bool]:
    """How Cycles takes a point or spot light: a soft one as a disk that faces what it lights, always before 4.0 and
    where it says so from 4.1 on; and before 4.0 a spot dims by its cosine. 'sphere': .04211 in 3.4.1, .04866 in 4.2.23;
    'spot': .04803, .04867."""
    old = bpy.app.version < (4, 0, 0)
    return {"facing_disk": old or bool(getattr(light, "use_soft_falloff", False)), "spot_cosine": old}


def scale_stretches_cones() -> bool:
    """Whether the scale of a spot's object stretches its cone in Cycles, as from 4.0 on; that of points and their radius
    means nothing in any. lamp_scale.py, 'spot 1,2,1': as wide as tall in 3.4.1, 1.75 times as tall in 4.2.23."""
    return bool(bpy.app.version >= (4, 0, 0))


def masks_apart() -> float:
    """1 where Cycles multiplies the two G1 of Smith's masking, as before 4.0; 0 where it correlates them by height. 3.4.1
    against 4.2.23: lights.py, roughness 1."""
    return float(bpy.app.version < (4, 0, 0))


def principled_has_layers() -> bool:
    """Whether a Principled BSDF is a metal beside, and gloss above, what is diffuse, each with a reflectance of its own,
    and what one reflects the others do not get: from 4.0 on. Before, one gloss lies over the diffuse part and takes nothing
    of its light, and metals rise to white as dielectrics do. 'smooth, from 75 degrees': .6684 in 3.4.1, .5266 in 4.2.23;
    'half metal, rough': .1855, .2583."""
    return bool(bpy.app.version >= (4, 0, 0))


def facets_are_lossless(shader: Any) -> bool:
    """Whether gloss is to have what its facets send to each other, as Multiscatter GGX has it, the default from 4.0 on.
    Before, the same name meant paths between facets, and was no default. 'rough metal': .2211 in 3.4.1, .5429 in 4.2.23.
    """
    return bool(bpy.app.version >= (4, 0, 0)) and shader.distribution == "MULTI_GGX"


def has_transparent_shadow(material: Any) -> bool:
    """A setting of Cycles before 4.2, and of every material since."""
    own = getattr(material, "use_transparent_shadow", None)
    return bool(getattr(getattr(material, "cycles", None), "use_transparent_shadow", True) if own is None else own)


def grooves() -> int:
    """What kind of native diffuse surface Cycles' rough ones are, by Oren and Nayar: until 4.2.23 of one reflection, from
    4.3.2 on of all, and up to 5.2.2 with the later ones in the colour of one reflection more. 'rough diffuse, towards the
    light': .0777 in 4.2.23, .1044 in 4.3.2 and 5.2.2, .1110 in 5.3.0."""
    return 2 if bpy.app.version < (4, 3, 0) else 4 if bpy.app.version < (5, 3, 0) else 3


def emission_socket(principled: Any) -> str:
    """The name of the socket of the colour in which a Principled BSDF glows."""
    return "Emission Color" if "Emission Color" in principled.inputs else "Emission"  # 4.0


def uses_nodes(owner: Any) -> bool:
    """Whether a material or world is made of nodes: always so since 5.0. A new world's are None in 4.5.15, in 5.0.1 not."""
    return bpy.app.version >= (5, 0, 0) or bool(owner.use_nodes)


def compositing_tree(scene: Any) -> Any:
    """The nodes that a scene's picture goes through, switched on; made where there are none. A tree of the file's since 5.0,
    of the scene's own before."""
    if not hasattr(scene, "compositing_node_group"):
        scene.use_nodes = True
        tree = scene.node_tree
    else:
        if scene.compositing_node_group is None:
            scene.compositing_node_group = bpy.data.node_groups.new(f"{scene.name} Compositing", "CompositorNodeTree")
        tree = scene.compositing_node_group
    scene.render.use_compositing = True
    return tree


def remove_compositing(scene: Any) -> None:
    """Let a scene's picture go through no nodes."""
    if hasattr(scene, "compositing_node_group"):
        scene.compositing_node_group = None
    else:
        scene.use_nodes = False


def compositing_output(tree: Any) -> Any:
    """The socket that takes the finished picture of a compositor's nodes: of a Composite node before 5.0, of the group's
    output since."""
    if hasattr(bpy.types, "CompositorNodeComposite"):
        found = [node for node in tree.nodes if node.type == "COMPOSITE"]
        node = found[0] if found else tree.nodes.new("CompositorNodeComposite")
        return node.inputs["Image"]
    if not any(item.item_type == "SOCKET" and item.in_out == "OUTPUT" for item in tree.interface.items_tree):
        tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
    found = [node for node in tree.nodes if node.type == "GROUP_OUTPUT"]
    node = found[0] if found else tree.nodes.new("NodeGroupOutput")
    return node.inputs[0]


def multiply_node(tree: Any) -> tuple[Any, tuple[Any, Any], Any]:
    """A compositor's node that multiplies colours: it, its two inputs and its output. 4.5.15 against 5.0.1: 'Node type
    CompositorNodeMixRGB undefined'."""
    if hasattr(bpy.types, "CompositorNodeMixRGB"):
        node = tree.nodes.new("CompositorNodeMixRGB")
        node.blend_type = "MULTIPLY"
        return node, colour_inputs(node), node.outputs[0]
    node = tree.nodes.new("ShaderNodeMix")
    node.data_type, node.blend_type, node.clamp_result = "RGBA", "MULTIPLY", False
    node.inputs[0].default_value = 1.0
    return node, colour_inputs(node), next(socket for socket in node.outputs if socket.type == "RGBA")


def over_node(tree: Any) -> tuple[Any, tuple[Any, Any]]:
    """A compositor's node that lays one premultiplied picture over another: it, and the inputs of that behind and before."""
    node = tree.nodes.new("CompositorNodeAlphaOver")
    return node, colour_inputs(node)


def colour_inputs(node: Any) -> tuple[Any, Any]:
    """The two colours that a compositor's node makes one of."""
    first, second = [socket for socket in node.inputs if socket.type == "RGBA"][:2]
    return first, second


def textures_have_types() -> bool:
    """Whether a Noise Texture's Roughness and a Wave Texture's may be above 1, as from 4.0 on: 3.4.1 against 4.2.0."""
    return bool(bpy.app.version >= (4, 0, 0))


def noise_repeats() -> int:
    """1 where noise repeats itself in each direction, as far as single precision knows a place: 4.2.0 and 5.0.1; 0 in 3.4.1."""
    return int(bpy.app.version >= (4, 0, 0))


def voronoi_edition() -> int:
    """How the cells of a Voronoi Texture are hashed and bounded, as shaders/textures has it: 3.4.1, 4.2.0 and 5.0.1."""
    return 0 if bpy.app.version < (4, 0, 0) else 1 if bpy.app.version < (5, 0, 0) else 2


def premultiplied_stays_so() -> bool:
    """Whether Cycles takes packed and generated bytes whose alpha is Premultiplied for multiplied by alpha already, rather
    than multiplying them: 5.2.2 against 5.0.1, image_texels.py."""
    return bool(bpy.app.version >= (5, 2, 0))
