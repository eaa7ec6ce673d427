#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Usage: findings/an_engines_frame_set_stays.sh
#
# Blender (bpy 4.2.23 and 5.0.1 from PyPI; Debian 12's 3.4.1 alike): RenderEngine.frame_set, which is there for motion
# blur, moves the artist's scene and not only what the engine is given, and nobody moves it back. After an F12 at frame 2
# by an engine that looked at frame 5.5 the scene stands at 5.5; and an animation of the frames 1 to 3 ends after its first,
# without a word and with success: the loop over frames counts on from where the engine left the scene. An engine that
# looks elsewhere has to come back to frame_current and frame_subframe before render() ends.
#
# Seen: scene at 5.5, animation of 3 frames: 1 rendered; with an engine that comes back: scene at 2.0, 3 rendered
#
# Fails if that changes.

set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
for version in 4.2.23 5.0.1; do
    python3.11 -m venv "$folder/$version"
    "$folder/$version/bin/pip" install --quiet "bpy==$version" 'numpy<2'
    "$folder/$version/bin/python" - "$version" "$folder" <<'PYTHON'
import sys

import bpy

assert bpy.app.version_string.startswith(sys.argv[1]), bpy.app.version_string


class Looking(bpy.types.RenderEngine):
    """Looks at another frame, as for motion blur, and comes back if it is told to."""

    bl_idname, bl_label = "LOOKING", "Looking"
    comes_back = False

    def render(self, depsgraph):
        now = depsgraph.scene.frame_current, depsgraph.scene.frame_subframe
        self.frame_set(5, 0.5)
        if self.comes_back:
            self.frame_set(*now)
        self.end_result(self.begin_result(0, 0, 8, 8))


bpy.utils.register_class(Looking)
scene = bpy.context.scene
scene.render.engine = "LOOKING"
scene.render.resolution_x = scene.render.resolution_y = 8
scene.render.filepath = f"{sys.argv[2]}/frame"
scene.frame_start, scene.frame_end = 1, 3
rendered = []
bpy.app.handlers.render_post.append(lambda *_: rendered.append(scene.frame_current_final))


def tried():
    scene.frame_set(2)
    bpy.ops.render.render()
    stands = scene.frame_current_final
    rendered.clear()
    bpy.ops.render.render(animation=True)
    return stands, len(rendered)


left = tried()
Looking.comes_back = True
back = tried()
print(f"{sys.argv[1]}: scene at {left[0]}, animation of 3 frames: {left[1]} rendered; "
      f"with an engine that comes back: scene at {back[0]}, {back[1]} rendered")
assert left == (5.5, 1) and back == (2.0, 3)
bpy.app.handlers.render_post.clear()
scene.render.engine = "BLENDER_WORKBENCH"
bpy.utils.unregister_class(Looking)
PYTHON
done
