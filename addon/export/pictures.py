# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's images as linear colours."""

from __future__ import annotations

import os
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from .. import core
from .parts import Owner, Parts
from .shading.directions import Picture

# As Cycles shows what it cannot find.
MISSING = Picture(np.array([[(1.0, 0.0, 1.0)]], np.float32), "missing")
# Whose bytes are light as it is; of the others, which are written with a curve, what sRGB's makes of them is shown.
_LINEAR = {"Non-Color", "Raw", "Linear", "Linear Rec.709", "Generic Data"}
_CURVED = {"sRGB"}


def picture_of(image: Any, parts: Parts, owner: str, notices: list[str]) -> Picture:
    """What an image shows, or MISSING. Of a sequence or a movie what Blender has loaded of it."""

    def say(what: str) -> None:
        if what not in notices:
            notices.append(what)

    if image is None:
        say(f"{owner}: a texture has no image; it is magenta")
        return MISSING
    width, height = image.size
    if image.source in {"SEQUENCE", "MOVIE"} and not (width and height):  # which Blender reads when it draws it
        say(f"{owner}: image {image.name} is a sequence or a movie, which is not followed; it is magenta")
        return MISSING
    if not (width and height):
        place = bpy.path.abspath(image.filepath, library=image.library)
        say(f"{owner}: image {image.name} cannot be read{f' from {place}' if place else ''}; it is magenta")
        return MISSING
    if image.source in {"SEQUENCE", "MOVIE", "TILED"}:
        kinds = {"SEQUENCE": "a sequence, of which one frame", "MOVIE": "a movie, of which one frame"}
        say(f"{owner}: image {image.name} is {kinds.get(image.source, 'in tiles, of which the first')} is shown")
    space = image.colorspace_settings.name
    if not image.is_float and space not in _LINEAR | _CURVED:
        say(f"{owner}: image {image.name}'s Color Space {space} is shown as sRGB")
    told = parts.told and not image.is_dirty
    made: Picture | None = parts.part(
        lambda: _read(image),
        ("picture",),
        _picture,
        Owner((image.as_pointer(),), _fingerprint(image)) if told else None,
    )
    if made is None:
        return MISSING
    if "clear" in made.digest:
        say(f"{owner}: where image {image.name} is not opaque, its Alpha {image.alpha_mode.title()} is not followed")
    if "broken" in made.digest:
        say(f"{owner}: image {image.name} holds values that are not finite, or are negative; they are black")
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
