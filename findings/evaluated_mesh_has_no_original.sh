#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Usage: findings/evaluated_mesh_has_no_original.sh
#
# Blender (bpy 4.5.15 from PyPI; 3.4.1 of Debian 12 answers alike): the mesh of an evaluated object claims to be no
# evaluated data at all. `ID.original` is documented as the data-block of the file that evaluated data stands for, and
# for the object it is; but `evaluated_object.data.original` is the evaluated mesh itself, and its `is_evaluated` is
# False, with modifiers and without any. So the way from evaluated geometry to the artist's mesh leads through the
# object: `evaluated_object.original.data`; and caches keyed by `mesh.original` never hit twice.
#
# Seen, for a cube without a modifier and for the same with one:
#   object: evaluated True, original is the file's True
#   mesh: evaluated False, original is the file's False, is itself True
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
cube = bpy.data.objects["Cube"]
for modifiers in range(2):
    if modifiers:
        cube.modifiers.new("Subdivision", "SUBSURF")
    depsgraph = bpy.context.evaluated_depsgraph_get()
    depsgraph.update()
    seen = cube.evaluated_get(depsgraph)
    mesh = seen.data
    print(f"object: evaluated {seen.is_evaluated}, original is the file's {seen.original == cube}")
    print(
        f"mesh: evaluated {mesh.is_evaluated}, original is the file's {mesh.original == cube.data}, "
        f"is itself {mesh.original == mesh}"
    )
    assert (seen.is_evaluated, seen.original == cube) == (True, True)
    assert (mesh.is_evaluated, mesh.original == cube.data, mesh.original == mesh) == (False, False, True)
PYTHON
