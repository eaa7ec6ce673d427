# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/side_by_side.png, the plume by Cycles in five times the time, by Sfumato, and by Cycles in 300 times the time; and
docs/gallery.png, docs/glass.png, docs/textures.png, docs/room.png, docs/street.png and docs/fog.png, the samples of these names by Sfumato and by Cycles.

PATH=/usr/bin:$PATH blender -b blend_samples/plume.blend --addons sfumato --python docs/side_by_side.py
PATH=/usr/bin:$PATH blender -b blend_samples/gallery.blend --addons sfumato --python docs/side_by_side.py
PATH=/usr/bin:$PATH blender -b blend_samples/glass.blend --addons sfumato --python docs/side_by_side.py
PATH=/usr/bin:$PATH blender -b blend_samples/textures.blend --addons sfumato --python docs/side_by_side.py
PATH=/usr/bin:$PATH blender -b blend_samples/room.blend --addons sfumato --python docs/side_by_side.py
PATH=/usr/bin:$PATH blender -b blend_samples/street.blend --addons sfumato --python docs/side_by_side.py
PATH=/usr/bin:$PATH blender -b blend_samples/fog.blend --addons sfumato --python docs/side_by_side.py
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import bpy
import numpy as np
from numpy.typing import NDArray

DOCS = Path(__file__).resolve().parent
# Rows from the bottom, columns; engines and samples of Cycles; the picture.
SAMPLES = {
    "plume": ((slice(0, 345), slice(60, 480)), (("CYCLES", 1), ("SFUMATO", 1), ("CYCLES", 64)), "side_by_side.png"),
    "gallery": ((slice(0, 360), slice(0, 640)), (("SFUMATO", 1), ("CYCLES", 64)), "gallery.png"),
    "glass": ((slice(0, 360), slice(0, 640)), (("SFUMATO", 1), ("CYCLES", 64)), "glass.png"),
    "textures": ((slice(0, 360), slice(0, 640)), (("SFUMATO", 1), ("CYCLES", 64)), "textures.png"),
    "room": ((slice(0, 360), slice(0, 640)), (("SFUMATO", 1), ("CYCLES", 256)), "room.png"),
    "street": ((slice(0, 360), slice(0, 640)), (("SFUMATO", 1), ("CYCLES", 16)), "street.png"),
    "fog": ((slice(0, 400), slice(0, 640)), (("SFUMATO", 1), ("CYCLES", 64)), "fog.png"),
}


def shown(engine: str, samples: int) -> NDArray[np.float32]:
    """The picture as the screen shows it: (height, width, 4)."""
    scene = bpy.context.scene
    scene.render.engine = engine
    scene.cycles.samples = samples
    scene.render.image_settings.file_format = "PNG"
    with tempfile.TemporaryDirectory() as folder:
        scene.render.filepath = str(Path(folder) / "part.png")
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(scene.render.filepath)
        image.colorspace_settings.name = "Non-Color"  # as it is stored, whatever the scene's view transform
        pixels = np.empty(len(image.pixels), dtype=np.float32)
        image.pixels.foreach_get(pixels)
        return pixels.reshape(image.size[1], image.size[0], 4)


def main() -> None:
    crop, renders, name = SAMPLES[Path(bpy.data.filepath).stem]
    parts = [shown(engine, samples)[crop] for engine, samples in renders]
    gap = np.ones((parts[0].shape[0], 6, 4), dtype=np.float32)
    row = np.concatenate([part for picture in parts for part in (picture, gap)][:-1], axis=1)
    image = bpy.data.images.new("row", row.shape[1], row.shape[0], is_data=True)
    image.pixels.foreach_set(row.ravel())
    image.filepath_raw, image.file_format = str(DOCS / name), "PNG"
    image.save()


if __name__ == "__main__":
    main()
