#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Usage: findings/a_missing_frame_taints_the_next.sh
#
# Volume objects (bpy 4.5.15 from PyPI; 5.0.1 and Debian's 3.4.1 answer alike): where one file of an OpenVDB sequence is
# missing, the next frame is loaded, its grids are there and is_loaded is True, but grids.load() still returns False and
# grids.error_message still names the missing file. Of frames that were read before the gap both are right again. So
# neither says whether a frame is there; frame_filepath does.
#
# Seen, of files 1, 2 and 4, at frames 2, 3, 4 and 2 (file, load(), is_loaded, grids, error_message):
#   frame 2: 'smoke_2.vdb' True True 1 ''
#   frame 3: '' False False 0 'smoke_3.vdb not found'
#   frame 4: 'smoke_4.vdb' False True 1 'smoke_3.vdb not found'
#   frame 2: 'smoke_2.vdb' True True 1 ''
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

bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
bpy.ops.mesh.primitive_cube_add()
cube = bpy.context.object
made = bpy.data.objects.new("Made", bpy.data.volumes.new("Made"))
scene.collection.objects.link(made)
made.modifiers.new("Mesh to Volume", "MESH_TO_VOLUME").object = cube
bpy.context.view_layer.update()
voxels = made.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.grids
for number in (1, 2, 4):
    assert voxels.save(filepath=str(Path(f"smoke_{number}.vdb").resolve()))

data = bpy.data.volumes.new("Smoke")
data.filepath, data.is_sequence = str(Path("smoke_1.vdb").resolve()), True
data.frame_start, data.frame_duration = 1, 4
thing = bpy.data.objects.new("Smoke", data)
scene.collection.objects.link(thing)


def ask(frame):
    scene.frame_set(frame)
    grids = thing.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.grids
    loads = grids.load()
    answer = Path(grids.frame_filepath).name, loads, grids.is_loaded, len(grids), grids.error_message
    print(f"frame {frame}:", *map(repr, answer))
    return answer


assert bpy.app.version == (4, 5, 15), bpy.app.version_string
assert ask(2) == ("smoke_2.vdb", True, True, 1, "")
assert ask(3) == ("", False, False, 0, "smoke_3.vdb not found")
assert ask(4) == ("smoke_4.vdb", False, True, 1, "smoke_3.vdb not found")
assert ask(2) == ("smoke_2.vdb", True, True, 1, "")
PYTHON
