#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Make the two archives of a built add-on:  pack.py ADDON FOLDER

ADDON is the folder `sfumato` as the build leaves it. In FOLDER: sfumato-VERSION.zip, an extension for Blender 4.2 and
later, with the manifest at its top; and sfumato-VERSION-before-4.2.zip, with all in a folder. Equal files give equal
bytes. Prints a line for each archive.
"""

from __future__ import annotations

import re
import sys
import zipfile
from collections.abc import Mapping
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
LISTING = "contents.txt"


def contents(addon: Path) -> dict[str, bytes]:
    """Of each file of the add-on its path and its bytes, in order, with our licence, and with a listing of all, by which
    the add-on finds out at its start whether it is whole."""
    files = {
        path.relative_to(addon).as_posix(): path.read_bytes()
        for path in addon.rglob("*")
        if path.is_file() and "__pycache__" not in path.parts and path.name != LISTING
    }
    files["LICENSE"] = (ROOT / "LICENSE").read_bytes()
    files[LISTING] = "".join(f"{len(files[name])} {name}\n" for name in sorted(files)).encode()
    return dict(sorted(files.items()))


def write(archive: Path, files: Mapping[str, bytes], folder: str = "") -> None:
    with zipfile.ZipFile(archive, "w") as out:
        for name, data in files.items():
            entry = zipfile.ZipInfo(folder + name)  # of 1980, the earliest time that there is
            entry.external_attr = 0o100644 << 16
            entry.create_system = 3  # else it would be that of whoever packs
            # The modules are nearly all of it: 14.7 MB in the place of 20.6. Blender unpacks by Python, which knows both.
            kind = zipfile.ZIP_LZMA if name.endswith(".so") else zipfile.ZIP_DEFLATED
            out.writestr(entry, data, kind, compresslevel=9)


def pack(addon: Path, folder: Path) -> list[Path]:
    """The extension and the older archive. Raises ValueError for a folder without a manifest that states a version."""
    files = contents(addon)
    version = re.search(r'^version = "([\d.]+)"$', files.get("blender_manifest.toml", b"").decode(), re.MULTILINE)
    if not version:
        raise ValueError(f"{addon} has no blender_manifest.toml with a version")
    extension = folder / f"sfumato-{version[1]}.zip"
    older = folder / f"sfumato-{version[1]}-before-4.2.zip"
    write(extension, files)
    write(older, files, "sfumato/")
    return [extension, older]


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    for made in pack(Path(sys.argv[1]), Path(sys.argv[2])):
        print(f"{made}: {made.stat().st_size / 1e6:.2f} MB")
