#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Usage: findings/curves_are_instanced_twice.sh
#
# Blender (bpy 4.5.15 from PyPI; 3.4.1 of Debian 12 answers alike): `depsgraph.object_instances` yields a curve with a
# bevel twice under the same object: once as the curve, not an instance, and once as an instance whose `object.type` is
# MESH. Nothing is instanced in the scene. `to_mesh()` of either gives the same polygons in the same place, so an
# exporter that takes everything with a mesh draws, and with alpha blends, each curve twice.
#
# Seen, for one Bezier circle with a bevel:
#   CURVE instance False polygons 576
#   MESH instance True polygons 576
#
# Fails if that changes.

set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3.11 -m venv "$folder/env"
"$folder/env/bin/pip" install --quiet 'bpy==4.5.15' 'numpy<2'
"$folder/env/bin/python" - <<'PYTHON'
import bpy

assert bpy.app.version == (4, 5, 15), bpy.app.version_string
bpy.ops.wm.read_homefile(use_factory_startup=True)
bpy.ops.curve.primitive_bezier_circle_add()
curve = bpy.context.object
curve.data.bevel_depth = 0.1
depsgraph = bpy.context.evaluated_depsgraph_get()
depsgraph.update()
seen = []
for instance in depsgraph.object_instances:
    thing = instance.object
    if thing.original == curve:
        seen.append((thing.type, instance.is_instance, len(thing.to_mesh().polygons)))
        thing.to_mesh_clear()
for kind, instanced, polygons in seen:
    print(f"{kind} instance {instanced} polygons {polygons}")
assert [entry[:2] for entry in seen] == [("CURVE", False), ("MESH", True)], seen
assert seen[0][2] == seen[1][2] > 0, seen
PYTHON
