# SPDX-License-Identifier: GPL-3.0-or-later
"""Run a script in a Blender that is a Python module, with the installed extension:

    python start_wheel.py SCRIPT [BLEND]

What `blender -b BLEND --addons sfumato --python SCRIPT` does. `python` is any that finds `bpy`; SCRIPT is a file, or text
that begins with `import`. An exception ends it with status 1.
"""

from __future__ import annotations

import runpy
import sys

import bpy
import harness


def main(script: str, blend: str = "") -> None:
    harness.enable()
    if blend:
        bpy.ops.wm.open_mainfile(filepath=blend)
    if script.startswith("import"):
        exec(compile(script, "script", "exec"), {"__name__": "__main__"})
    else:
        runpy.run_path(script, run_name="__main__")


if __name__ == "__main__":
    main(*sys.argv[1:])
