# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's images: as linear colours, and as the texels that Cycles looks up on surfaces."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from .. import compat, core
from .parts import Owner, Parts
from .shading.directions import Picture

# As Cycles shows what it cannot find.
MISSING = Picture(np.array([[(1.0, 0.0, 1.0)]], np.float32), "missing")
# Whose numbers are no colours, so that alpha has no say in them.
_DATA = {"Non-Color", "Raw", "Generic Data"}
# Whose bytes are light as it is; of the others, which are written with a curve, what sRGB's makes of them is shown.
_LINEAR = _DATA | {"Linear", "Linear Rec.709"}
_CURVED = {"sRGB"}
# Files of floats in which colours are multiplied by alpha; in others they are not.
_ASSOCIATED = {"OPEN_EXR", "OPEN_EXR_MULTILAYER", "HDR"}
_ROWS = 64  # at a time, where what is calculated is larger than what is kept


@dataclass(frozen=True, eq=False)
class Texels:
    """What Cycles looks up: (height, width, 4), rows from the bottom up, uint8 or float32, with the arguments `curved` and
    `divided` of the native Image; `digest` is the same for equal ones. Of an image in tiles those of each, by its
    number, as u and v count them from 1001; the others' are the first one's."""

    pixels: NDArray[Any]
    digest: str
    curved: bool = False
    divided: bool = False
    tiles: dict[int, Texels] = field(default_factory=dict)

    def __repr__(self) -> str:
        return f"Texels({self.digest})"


MISSING_TEXELS = Texels(np.array([[(255, 0, 255, 255)]], np.uint8), "missing")
Say = Callable[[str], None]


def picture_of(image: Any, parts: Parts, owner: str, notices: list[str]) -> Picture:
    """What an image shows, or MISSING. Of a sequence or a movie what Blender has loaded of it."""
    say = _sayer(notices)
    if not _is_there(image, owner, say):
        return MISSING
    if image.source in {"SEQUENCE", "MOVIE", "TILED"}:
        kinds = {"SEQUENCE": "a sequence, of which one frame", "MOVIE": "a movie, of which one frame"}
        say(f"{owner}: image {image.name} is {kinds.get(image.source, 'in tiles, of which the first')} is shown")
    _name_space(image, owner, say)
    made: Picture | None = parts.part(lambda: _read(image), ("picture",), _picture, _owner(image, parts))
    if made is None:
        return MISSING
    if "clear" in made.digest:
        say(f"{owner}: where image {image.name} is not opaque, its Alpha {image.alpha_mode.title()} is not followed")
    _name_broken(image, made.digest, owner, say)
    return made


def texels_of(image: Any, user: Any, parts: Parts, owner: str, notices: list[str], alpha_linked: bool) -> Texels:
    """What Cycles looks up of an image on surfaces, or MISSING_TEXELS: at the frame of its user, and in all its tiles.
    `alpha_linked`: whether the node's Alpha leads anywhere, of which its Color depends. Of a movie what Blender has
    loaded of it."""
    say = _sayer(notices)
    if image is not None and image.source == "SEQUENCE":
        path = image.filepath_from_user(image_user=user) if user is not None else image.filepath_from_user()
        return _of_file(image, path, parts, owner, say, alpha_linked)
    if not _is_there(image, owner, say):
        return MISSING_TEXELS
    if image.source == "MOVIE":
        say(f"{owner}: image {image.name} is a movie, of which one frame is shown")
    _name_space(image, owner, say)
    if image.source == "TILED" and len(image.tiles) > 1:
        if not any(mark in image.filepath for mark in _TILE_MARKS) or image.packed_file is not None:
            say(f"{owner}: image {image.name} is in tiles, of which the first is shown")
        else:
            tiles = {
                tile.number: _of_file(image, tile_path(image, tile.number), parts, owner, say, alpha_linked)
                for tile in image.tiles
            }
            first = tiles[image.tiles[0].number]
            digest = " ".join(f"{number} {tile.digest}" for number, tile in tiles.items())
            return Texels(first.pixels, digest, first.curved, first.divided, tiles)
    return _of_image(image, parts, owner, say, alpha_linked)


def _sayer(notices: list[str]) -> Say:
    def say(what: str) -> None:
        if what not in notices:
            notices.append(what)

    return say


def _is_there(image: Any, owner: str, say: Say) -> bool:
    if image is None:
        say(f"{owner}: a texture has no image; it is magenta")
        return False
    width, height = image.size
    if width and height:
        return True
    if image.source in {"SEQUENCE", "MOVIE"}:  # which Blender reads when it draws it
        say(f"{owner}: image {image.name} is a sequence or a movie, which is not followed; it is magenta")
        return False
    place = bpy.path.abspath(image.filepath, library=image.library)
    say(f"{owner}: image {image.name} cannot be read{f' from {place}' if place else ''}; it is magenta")
    return False


def _name_space(image: Any, owner: str, say: Say) -> None:
    space = image.colorspace_settings.name
    if not image.is_float and space not in _LINEAR | _CURVED:
        say(f"{owner}: image {image.name}'s Color Space {space} is shown as sRGB")


def _name_broken(image: Any, digest: str, owner: str, say: Say) -> None:
    if "clear" in digest and compat.premultiplied_stays_so():
        say(f"{owner}: where image {image.name} is not opaque, its colors may not be those of this Blender's Cycles")
    if "broken" in digest:
        say(f"{owner}: image {image.name} holds values that are not finite, or are negative; they are black")


def _owner(image: Any, parts: Parts, *more: Any) -> Owner | None:
    if not parts.told or image.is_dirty:
        return None
    return Owner((image.as_pointer(),), (*_fingerprint(image), *more))


_TILE_MARKS = ("<UDIM>", "<UVTILE>")


def tile_path(image: Any, number: int) -> str:
    """The file of one tile of an image."""
    column, row = (number - 1001) % 10, (number - 1001) // 10
    names = dict(zip(_TILE_MARKS, (str(number), f"u{column + 1}_v{row + 1}")))
    path: str = image.filepath
    for mark, name in names.items():
        path = path.replace(mark, name)
    found: str = bpy.path.abspath(path, library=image.library)
    return found


def _of_file(image: Any, path: str, parts: Parts, owner: str, say: Say, alpha_linked: bool) -> Texels:
    """The texels of one of an image's files: Blender has the pixels of one alone."""
    path = bpy.path.abspath(path, library=image.library)
    try:
        written = os.stat(path).st_mtime_ns
    except OSError:
        say(f"{owner}: image {image.name} cannot be read from {path}; it is magenta")
        return MISSING_TEXELS

    def read() -> tuple[NDArray[Any], NDArray[np.float32]] | None:
        with _opened(image, path) as one:
            return None if one is None else _read_texels(one, alpha_linked)

    told = _owner(image, parts, path, written, alpha_linked)
    made: Texels | None = parts.part(read, ("texels",), _texels, told)
    if made is None:
        say(f"{owner}: image {image.name} cannot be read from {path}; it is magenta")
        return MISSING_TEXELS
    _name_broken(image, made.digest, owner, say)
    return made


@contextlib.contextmanager
def _opened(image: Any, path: str) -> Iterator[Any]:
    """A file as an image of its own, for as long as it takes to read it; None where that fails."""
    try:
        one = bpy.data.images.load(path, check_existing=False)
    except RuntimeError:
        yield None
        return
    try:
        one.colorspace_settings.name = image.colorspace_settings.name
        one.alpha_mode = image.alpha_mode
        yield one if one.size[0] and one.size[1] else None
    finally:
        bpy.data.images.remove(one)


def _of_image(image: Any, parts: Parts, owner: str, say: Say, alpha_linked: bool) -> Texels:
    told = _owner(image, parts, "texels", alpha_linked)
    made: Texels | None = parts.part(lambda: _read_texels(image, alpha_linked), ("texels",), _texels, told)
    if made is None:
        return MISSING_TEXELS
    _name_broken(image, made.digest, owner, say)
    return made


def _fingerprint(image: Any) -> tuple[Any, ...]:
    try:
        written = os.stat(bpy.path.abspath(image.filepath, library=image.library)).st_mtime_ns if image.filepath else 0
    except OSError:
        written = 0
    space = image.colorspace_settings.name
    packed = image.packed_file
    return (
        "picture", image.name, tuple(image.size), image.filepath, written, space, image.alpha_mode, image.source,
        image.generated_type, tuple(image.generated_color), 0 if packed is None else (packed.as_pointer(), packed.size),
    )  # fmt: skip


def _read(image: Any) -> tuple[NDArray[np.float32], ...] | None:
    """Pixels (height, width, channels), from the bottom up, as Blender keeps them; and what they mean."""
    width, height = image.size
    pixels = np.empty(width * height * image.channels, np.float32)
    if len(image.pixels) != len(pixels):
        return None
    image.pixels.foreach_get(pixels)
    curved = not image.is_float and image.colorspace_settings.name not in _LINEAR
    straight = not image.is_float and image.channels == 4 and image.alpha_mode == "STRAIGHT"
    # Cycles reads files by itself, and by these modes makes something else of them.
    other = image.channels == 4 and image.alpha_mode == ("STRAIGHT" if image.is_float else "PREMUL")
    return pixels.reshape(height, width, image.channels), np.array((curved, straight, other), np.float32)


def _read_texels(image: Any, alpha_linked: bool) -> tuple[NDArray[Any], NDArray[np.float32]] | None:
    """Texels, and what they mean. Of files Cycles reads the bytes by itself: what Blender made of them is undone."""
    width, height = image.size
    channels = image.channels
    pixels = np.empty(width * height * channels, np.float32)
    if not (width and height) or len(image.pixels) != len(pixels):
        return None
    image.pixels.foreach_get(pixels)
    pixels = pixels.reshape(height, width, channels)
    space, mode = image.colorspace_settings.name, image.alpha_mode
    counts = channels == 4 and space not in _DATA and mode in {"STRAIGHT", "PREMUL"}
    own = image.packed_file is not None or image.source in {"GENERATED", "MOVIE"}
    written = space not in _LINEAR and not (image.is_float and (own or space not in _CURVED))
    change: Change = _bytes if not image.is_float else _written_floats if written else _floats
    file = "" if own else image.file_format
    multiplied = file == "PNG" and _is_gray_with_alpha(bpy.path.abspath(image.filepath, library=image.library))
    out = np.empty((height, width, 4), np.float32 if image.is_float else np.uint8)
    broken = False
    for row in range(0, height, _ROWS):
        rows, to = pixels[row : row + _ROWS], out[row : row + _ROWS]
        if image.is_float:
            bad = ~np.isfinite(rows).all(axis=2)
            if space not in _DATA:
                bad |= (rows[..., :3] < 0.0).any(axis=2)
            if bad.any():
                broken = True
                rows[bad] = 0.0
        _four(rows, to)
        if mode == "NONE":
            to[..., 3] = 1.0 if image.is_float else 255
        if counts or change is _written_floats:
            change(to, mode if counts else "", file, multiplied)
    meaning = (written, counts and alpha_linked, broken)
    return out, np.array(meaning, np.float32)


def _is_gray_with_alpha(path: str) -> bool:
    """The one kind of a PNG file that Cycles takes for multiplied by alpha."""
    try:
        with open(path, "rb") as file:
            return file.read(26)[25:] == b"\4"
    except OSError:
        return False


Change = Callable[[NDArray[Any], str, str, bool], None]


def _four(rows: NDArray[np.float32], to: NDArray[Any]) -> None:
    """Four channels of one, three or four; exactly the bytes, where they are bytes."""
    scale = 255.0 if to.dtype == np.uint8 else 1.0
    rows = np.rint(rows * np.float32(scale)) if scale != 1.0 else rows
    to[..., :3] = rows[..., :3] if rows.shape[2] >= 3 else rows[..., :1]
    to[..., 3] = rows[..., 3] if rows.shape[2] == 4 else scale


def _bytes(to: NDArray[Any], mode: str, file: str, multiplied: bool) -> None:
    """Multiplied by alpha, as Cycles rounds. What is said to be so already Blender has divided by it."""
    alpha: Any = to[..., 3:].astype(np.uint32)
    colours: Any = to[..., :3].astype(np.uint32)
    if mode == "PREMUL" and file:
        colours = (2 * colours * alpha + 255) // 510
    if not multiplied and not (mode == "PREMUL" and not file and compat.premultiplied_stays_so()):
        colours = colours * alpha // 255
    to[..., :3] = colours


def _floats(to: NDArray[Any], mode: str, file: str, multiplied: bool) -> None:
    """Linear: Blender multiplies what is straight, and takes the rest as it is."""
    if not file or multiplied:
        return
    alpha = to[..., 3:]
    if mode == "STRAIGHT" and file in _ASSOCIATED:
        np.divide(to[..., :3], alpha, out=to[..., :3], where=alpha > 0.0)
    elif mode == "PREMUL" and file not in _ASSOCIATED:
        to[..., :3] *= alpha


def _written_floats(to: NDArray[Any], mode: str, file: str, multiplied: bool) -> None:
    """As they were before Blender decoded them, which it did after dividing them by alpha."""
    alpha, colours = to[..., 3:], to[..., :3]
    if mode:
        np.divide(colours, alpha, out=colours, where=alpha > 0.0)
    colours[...] = np.where(
        colours <= 0.0031308, 12.92 * colours, 1.055 * np.maximum(colours, 0.0031308) ** (1.0 / 2.4) - 0.055
    )
    if mode == "PREMUL":
        colours *= np.where(alpha > 0.0, alpha, 1.0)
    if mode and file not in _ASSOCIATED and not multiplied:
        colours *= alpha


def _texels(pixels: NDArray[Any], meaning: NDArray[np.float32]) -> Texels:
    curved, divided, broken = meaning > 0.0
    digest = core.module().content_hash(pixels, meaning).hex() + (" broken" if broken else "")
    if pixels.dtype != np.uint8 and pixels[..., 3].min() < 1.0:
        digest += " clear"
    return Texels(pixels, digest, bool(curved), bool(divided))


def _picture(pixels: NDArray[np.float32], meaning: NDArray[np.float32]) -> Picture:
    curved, straight, other = meaning > 0.0
    rgb = pixels[..., :3] if pixels.shape[2] >= 3 else np.repeat(pixels[..., :1], 3, axis=2)
    if straight:
        rgb = rgb * pixels[..., 3:]  # before its curve, as Cycles does
    sound = np.isfinite(rgb) & (rgb >= 0.0)
    broken = "" if sound.all() else " broken"
    clear = " clear" if other and pixels[..., 3].min() < 1.0 else ""
    rgb = np.ascontiguousarray(np.where(sound, rgb, 0.0) if broken else rgb, np.float32)
    return Picture(rgb, f"{core.module().content_hash(rgb, meaning).hex()}{broken}{clear}", bool(curved))
