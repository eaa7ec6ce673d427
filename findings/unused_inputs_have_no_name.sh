#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Usage: findings/unused_inputs_have_no_name.sh
#
# Blender (bpy 4.2.23 and 5.0.1 from PyPI, 4.5.15 alike): an input that a node has, but does not use as it is set, stands
# in the list of its inputs and is not found there by its name. inputs["Melanin"] of a new Principled Hair BSDF raises
# KeyError, inputs.get() gives None, and `in` is False, until its parametrization is Melanin. Debian 12's 3.4.1 finds it in
# any case. What reads a node's inputs by name, whatever its mode, fails; and what asks whether a Blender has an input at
# all is told no.
#
# Seen (in the list, found by name): True, False in both
#
# Fails if that changes.

set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
for version in 4.2.23 5.0.1; do
    python3.11 -m venv "$folder/$version"
    "$folder/$version/bin/pip" install --quiet "bpy==$version" 'numpy<2'
    "$folder/$version/bin/python" - "$version" <<'PYTHON'
import sys

import bpy

assert bpy.app.version_string.startswith(sys.argv[1]), bpy.app.version_string
material = bpy.data.materials.new("Hair")
material.use_nodes = True
node = material.node_tree.nodes.new("ShaderNodeBsdfHairPrincipled")
assert node.parametrization == "COLOR", node.parametrization
listed = "Melanin" in [socket.name for socket in node.inputs]
by_name = "Melanin" in node.inputs
assert (node.inputs.get("Melanin") is not None) == by_name
print(f"{sys.argv[1]}: {listed}, {by_name}")
assert listed and not by_name
node.parametrization = "MELANIN"
assert "Melanin" in node.inputs
PYTHON
done
