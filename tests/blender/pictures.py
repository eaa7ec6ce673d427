# SPDX-License-Identifier: GPL-3.0-or-later
"""Rendering a picture and reading it back."""

from __future__ import annotations

import tempfile
from pathlib import Path

import bpy
import numpy as np
from numpy.typing import NDArray


def read(path: Path) -> NDArray[np.float32]:
    """The pixels of a file, (height, width, 4), row 0 at the bottom, as they are stored."""
    image = bpy.data.images.load(str(path))
    image.colorspace_settings.name = "Non-Color"
    pixels = np.empty(image.size[0] * image.size[1] * 4, dtype=np.float32)
    image.pixels.foreach_get(pixels)
    height, width = image.size[1], image.size[0]
    bpy.data.images.remove(image)
    return pixels.reshape(height, width, 4)


def render(size: tuple[int, int] | None = None, engine: str = "SFUMATO") -> NDArray[np.float32]:
    """The scene through an engine: scene-linear pixels."""
    settings = bpy.context.scene.render
    settings.engine = engine
    settings.image_settings.file_format = "OPEN_EXR"
    settings.image_settings.color_mode = "RGBA"
    settings.image_settings.color_depth = "32"
    if size is not None:
        settings.resolution_x, settings.resolution_y = size
    with tempfile.TemporaryDirectory() as folder:
        settings.filepath = str(Path(folder) / "frame.exr")
        bpy.ops.render.render(write_still=True)
        return read(Path(settings.filepath))
