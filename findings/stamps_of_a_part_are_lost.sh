#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Usage: findings/stamps_of_a_part_are_lost.sh
#
# Render engines (bpy 4.5.15 from PyPI; 5.0.1 and Debian's 3.4.1 answer alike): RenderResult.stamp_data_add_field is there on what
# begin_result gives an engine to fill, raises nothing, and what it is told never reaches the file. Only fields of
# RenderEngine.get_result() do, and those may be added after end_result.
#
# Seen, of a field of either, in the header of the file:
#   begin_result(): False
#   get_result(): True
#
# Fails if that changes.

set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3.11 -m venv "$folder/env"
"$folder/env/bin/pip" install --quiet 'bpy==4.5.15' 'numpy<2'
cd "$folder"
"$folder/env/bin/python" - <<'PYTHON'
from pathlib import Path

import bpy


class Engine(bpy.types.RenderEngine):
    bl_idname, bl_label = "STAMPS", "Stamps"

    def render(self, depsgraph):
        part = self.begin_result(0, 0, 8, 8, layer=depsgraph.view_layer.name)
        part.stamp_data_add_field("Told a part", "lost")
        self.end_result(part)
        self.get_result().stamp_data_add_field("Told the whole", "kept")


bpy.utils.register_class(Engine)
render = bpy.context.scene.render
render.engine, render.filepath = "STAMPS", str(Path("frame.exr").resolve())
render.resolution_x = render.resolution_y = 8
render.image_settings.file_format = "OPEN_EXR"
bpy.ops.render.render(write_still=True)
data = Path("frame.exr").read_bytes()
part, whole = b"Told a part" in data, b"Told the whole" in data
print(f"begin_result(): {part}")
print(f"get_result(): {whole}")
assert (part, whole) == (False, True)
PYTHON
