# SPDX-License-Identifier: GPL-3.0-or-later
"""Texels of images, as the native module looks them up, beside the Image Texture of the Cycles of this very Blender."""

import itertools
import struct
import tempfile
import zlib
from pathlib import Path
from typing import Any

import bpy
import harness
import numpy as np
import pictures
from numpy.typing import NDArray
from sfumato import core  # type: ignore[attr-defined]
from sfumato.export import parts
from sfumato.export.pictures import MISSING_TEXELS, Texels, texels_of

SIZE = 40  # pixels
FROM, TO = -0.27, 1.31  # of u and v
SHAPE = (6, 8)  # texels
MODES = ("STRAIGHT", "PREMUL", "CHANNEL_PACKED", "NONE")


def png(path: Path, pixels: NDArray[Any]) -> Path:
    """A file of one to four channels, of 8 or 16 bits, as they are."""
    height, width, channels = pixels.shape
    rows = b"".join(b"\0" + row.astype(pixels.dtype.newbyteorder(">")).tobytes() for row in pixels[::-1])

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    kind = {1: 0, 2: 4, 3: 2, 4: 6}[channels]
    header = struct.pack(">IIBBBBB", width, height, 8 * pixels.dtype.itemsize, kind, 0, 0, 0)
    path.write_bytes(
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")
    )
    return path


def noise(channels: int, kind: type = np.uint8) -> NDArray[Any]:
    """Some texels are clear, or all but clear, and some opaque."""
    most = np.iinfo(kind).max
    out: NDArray[Any] = np.random.default_rng(3).integers(0, most, (*SHAPE, channels), endpoint=True).astype(kind)
    if channels in {2, 4}:
        out[0, :, -1], out[1, :, -1], out[2, 0, -1] = most, 0, 1
    return out


def floats() -> NDArray[np.float32]:
    out = np.random.default_rng(4).uniform(0.0, 2.0, (*SHAPE, 4)).astype(np.float32)
    out[..., 3] = np.minimum(0.6 * out[..., 3], 1.0)
    out[0] = 0.0
    return out


def plane() -> bpy.types.NodeTree:
    """A square that the camera sees from above, through points rather than pixels, and the nodes of its material."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    harness.enable()
    scene = bpy.context.scene
    cycles = scene.cycles
    cycles.samples, cycles.filter_width, cycles.pixel_filter_type = 1, 0.01, "GAUSSIAN"
    cycles.use_denoising = cycles.use_adaptive_sampling = False
    camera = bpy.data.cameras.new("Camera")
    camera.type, camera.ortho_scale = "ORTHO", 2.0
    scene.camera = bpy.data.objects.new("Camera", camera)
    scene.camera.location = (0.0, 0.0, 3.0)
    scene.collection.objects.link(scene.camera)
    bpy.ops.mesh.primitive_plane_add(size=2.0)
    mesh = bpy.context.object.data
    layer = mesh.uv_layers.active.data
    for loop in mesh.loops:
        x, y, _ = mesh.vertices[loop.vertex_index].co
        layer[loop.index].uv = (FROM + (TO - FROM) * (x + 1.0) / 2.0, FROM + (TO - FROM) * (y + 1.0) / 2.0)
    return harness.shade(mesh, "ShaderNodeEmission").id_data


def textured(tree: bpy.types.NodeTree, image: Any, alpha_linked: bool, **settings: Any) -> bpy.types.Node:
    for node in [node for node in tree.nodes if node.type in {"TEX_IMAGE", "MATH"}]:
        tree.nodes.remove(node)
    emission = next(node for node in tree.nodes if node.type == "EMISSION")
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    for name, value in settings.items():
        setattr(node, name, value)
    tree.links.new(node.outputs["Color"], emission.inputs["Color"])
    emission.inputs["Strength"].default_value = 1.0
    if alpha_linked:  # with next to no effect
        next_to_none = tree.nodes.new("ShaderNodeMath")
        next_to_none.operation = "MULTIPLY_ADD"
        next_to_none.inputs[1].default_value, next_to_none.inputs[2].default_value = 1e-7, 1.0
        tree.links.new(node.outputs["Alpha"], next_to_none.inputs[0])
        tree.links.new(next_to_none.outputs[0], emission.inputs["Strength"])
    return node


def places() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    along = FROM + (TO - FROM) * (np.arange(SIZE) + 0.5) / SIZE
    u, v = np.meshgrid(along, along)
    return u.ravel(), v.ravel()


def looked_up(texels: Texels, interpolation: str, extension: str) -> NDArray[np.float32]:
    image = core.module().Image(texels.pixels, texels.curved, texels.divided)
    found = image.look_up(*places(), interpolation=interpolation.lower(), extension=extension.lower())
    return np.asarray(found.reshape(SIZE, SIZE, 4), np.float32)


def beside(tree: bpy.types.NodeTree, image: Any, case: str, most: float = 2e-4, **settings: Any) -> list[str]:
    """What our colours are off those of Cycles by, relative to what is bright, must be little; and the notices."""
    said: list[str] = []
    settings = {"interpolation": "Linear", "extension": "REPEAT", **settings}
    for alpha_linked in (False, True):
        node = textured(tree, image, alpha_linked, **settings)
        theirs = pictures.render((SIZE, SIZE), "CYCLES")[..., :3]
        texels = texels_of(image, node.image_user, parts.Parts(), "Plane", said, alpha_linked)
        ours = looked_up(texels, settings["interpolation"], settings["extension"])[..., :3]
        off = np.abs(ours - theirs) / (1.0 + theirs)
        # What is all but clear is divided by next to nothing, of which Cycles has other digits.
        worst = float(np.quantile(off, 0.97) if alpha_linked else off.max())
        assert worst < most, (case, alpha_linked, worst)
    return said


def skip_what_is_named() -> None:
    """What Cycles makes of the alpha of floats since 5.2 is not followed yet."""
    if bpy.app.version >= (5, 2, 0):
        raise harness.Skip("the alpha of floats is named")


def test_files_are_what_cycles_reads() -> None:
    skip_what_is_named()
    tree = plane()
    with tempfile.TemporaryDirectory() as folder:
        files = [
            png(Path(folder) / f"{kind.__name__}{channels}.png", noise(channels, kind))
            for kind in (np.uint8, np.uint16)
            for channels in (1, 2, 3, 4)
        ]
        exr = bpy.data.images.new("Saved", SHAPE[1], SHAPE[0], alpha=True, float_buffer=True)
        exr.pixels.foreach_set(floats().ravel())
        exr.file_format, exr.filepath_raw = "OPEN_EXR", str(Path(folder) / "floats.exr")
        exr.save()
        files.append(Path(exr.filepath_raw))
        spaces = ("sRGB", "Non-Color", "Linear" if bpy.app.version < (4, 0) else "Linear Rec.709")
        for file, mode, space in itertools.product(files, MODES, spaces):
            has_alpha = file.stem[-1] in "24s"
            if (mode != "STRAIGHT" and not has_alpha) or file.stem == "uint162":
                continue
            image = bpy.data.images.load(str(file))
            image.alpha_mode, image.colorspace_settings.name = mode, space
            # What Blender divided by alpha, and cut, is lost.
            lost = mode == "PREMUL" and (space == "sRGB" or space != "Non-Color" and file.suffix == ".png")
            if not lost:
                beside(tree, image, f"{file.name} {mode} {space}")
            if file.stem in {"uint84", "floats"}:
                image.pack()
                beside(tree, image, f"{file.name} {mode} {space}, packed")
            bpy.data.images.remove(image)


def test_what_blender_makes_is_what_cycles_shows() -> None:
    skip_what_is_named()
    tree = plane()
    for float_buffer, mode in itertools.product((False, True), MODES):
        image = bpy.data.images.new("Made", SHAPE[1], SHAPE[0], alpha=True, float_buffer=float_buffer)
        image.alpha_mode = mode
        image.pixels.foreach_set((floats() if float_buffer else noise(4) / 255.0).astype(np.float32).ravel())
        image.update()
        assert not beside(tree, image, f"{float_buffer} {mode}")
    extensions = ("REPEAT", "EXTEND", "CLIP", *(("MIRROR",) if bpy.app.version >= (3, 5, 0) else ()))
    for interpolation, extension in itertools.product(("Linear", "Closest", "Cubic"), extensions):
        case = f"{interpolation} {extension}"
        beside(tree, image, case, interpolation=interpolation, extension=extension)


def test_what_is_no_colour_is_black_and_named() -> None:
    tree = plane()
    image = bpy.data.images.new("Broken", SHAPE[1], SHAPE[0], alpha=True, float_buffer=True)
    pixels = floats()
    pixels[2, 2, 0], pixels[3, 3, 1], pixels[4, 4, 2] = np.nan, np.inf, -1.0
    image.pixels.foreach_set(pixels.ravel())
    image.update()
    said: list[str] = []
    node = textured(tree, image, False)
    texels = texels_of(image, node.image_user, parts.Parts(), "Plane", said, False)
    assert not texels.pixels[[2, 3, 4], [2, 3, 4]].any() and texels.pixels[5].any()
    assert any("Broken holds values that are not finite" in one for one in said), said
    image = bpy.data.images.new("Numbers", SHAPE[1], SHAPE[0], alpha=True, float_buffer=True, is_data=True)
    image.pixels.foreach_set(pixels.ravel())  # which may be negative
    image.update()
    texels = texels_of(image, node.image_user, parts.Parts(), "Plane", said, False)
    assert texels.pixels[4, 4, 2] == -1.0


def test_what_is_not_there_is_magenta_and_named() -> None:
    plane()
    said: list[str] = []
    missing = bpy.data.images.new("Missing", 8, 8)
    missing.source, missing.filepath = "FILE", "//not_there.png"
    assert texels_of(missing, None, parts.Parts(), "Plane", said, False) is MISSING_TEXELS
    assert texels_of(None, None, parts.Parts(), "Plane", said, False) is MISSING_TEXELS
    assert any("Missing cannot be read" in one for one in said), said
    assert any("has no image" in one for one in said), said


def test_a_sequence_is_followed() -> None:
    tree = plane()
    with tempfile.TemporaryDirectory() as folder:
        for frame in (1, 2, 3):
            png(Path(folder) / f"frame_{frame:03}.png", np.full((*SHAPE, 3), 60 * frame, np.uint8))
        image = bpy.data.images.load(str(Path(folder) / "frame_001.png"))
        image.source = "SEQUENCE"
        node = textured(tree, image, False)
        node.image_user.frame_duration, node.image_user.use_auto_refresh = 3, True
        known, count = parts.Parts(told=True), len(bpy.data.images)
        for frame in (1, 2, 3, 2):
            bpy.context.scene.frame_set(frame)
            material = (
                bpy.context.object.evaluated_get(bpy.context.evaluated_depsgraph_get()).material_slots[0].material
            )
            user = next(node for node in material.node_tree.nodes if node.type == "TEX_IMAGE").image_user
            said: list[str] = []
            texels = texels_of(image, user, known, "Plane", said, False)
            assert (texels.pixels[..., 0] == 60 * frame).all() and not said, (frame, said)
            known.end_export()
        assert len(bpy.data.images) == count
        (Path(folder) / "frame_002.png").unlink()
        assert texels_of(image, user, parts.Parts(), "Plane", said, False) is MISSING_TEXELS
        assert any("frame_002.png" in one for one in said), said


def test_tiles_are_all_read() -> None:
    plane()
    with tempfile.TemporaryDirectory() as folder:
        for number in (1001, 1002, 1011):
            png(Path(folder) / f"tile.{number}.png", np.full((*SHAPE, 3), number % 200, np.uint8))
        image = bpy.data.images.load(str(Path(folder) / "tile.1001.png"))
        image.source, image.filepath = "TILED", str(Path(folder) / "tile.<UDIM>.png")
        for number in (1002, 1003, 1011):
            image.tiles.new(number)
        said: list[str] = []
        texels = texels_of(image, None, parts.Parts(), "Plane", said, True)
        assert set(texels.tiles) == {1001, 1002, 1003, 1011}
        assert texels.tiles[1003] is MISSING_TEXELS and any("1003" in one for one in said), said
        for number in (1001, 1002, 1011):
            assert (texels.tiles[number].pixels[..., :3] == number % 200).all()


def test_equal_images_are_one_part() -> None:
    plane()
    known = parts.Parts(told=True)
    images = [bpy.data.images.new(f"Image {number}", 4, 4) for number in (1, 2)]
    for image in images:
        image.pixels.foreach_set(np.full(64, 0.5, np.float32))
    first, second = (texels_of(image, None, known, "Plane", [], False) for image in images)
    assert first is second and first.pixels.dtype == np.uint8
    assert texels_of(images[0], None, known, "Plane", [], True) is not first


harness.main()
