# SPDX-License-Identifier: GPL-3.0-or-later
"""Run a script in a Blender that is a Python module, with the installed extension:

    python start.py SCRIPT [BLEND]

What `blender -b BLEND --addons sfumato --python SCRIPT` does. `python` is any that finds `bpy`; SCRIPT is a file, or text
that begins with `import`; one of interface/ gets a GPU without a window, from 5.1 on. An exception ends it with status 1.
"""

from __future__ import annotations

import runpy
import sys
from pathlib import Path

import bpy
import harness


def main(script: str, blend: str = "") -> None:
    harness.enable()
    if Path(script).parent.name == "interface":
        import gpu

        gpu.init()
    if blend:
        bpy.ops.wm.open_mainfile(filepath=blend)
    if script.startswith("import"):
        exec(compile(script, "script", "exec"), {"__name__": "__main__"})
    else:
        runpy.run_path(script, run_name="__main__")


if __name__ == "__main__":
    main(*sys.argv[1:])
