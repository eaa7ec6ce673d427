# SPDX-License-Identifier: GPL-3.0-or-later
"""Loads the native module, or explains why it cannot."""

from __future__ import annotations

import importlib
import sys
from types import ModuleType

_REMEDY = (
    "Build it with the Python of this Blender (see the README), or install the archive made for this platform; "
    "then restart Blender."
)


class Missing(RuntimeError):
    """The native module cannot be used; the message says why and what to do."""


def module() -> ModuleType:
    """The numeric module. Raises Missing where it cannot be loaded."""
    try:
        return importlib.import_module("._native.sfumato", __package__)
    except ImportError as error:
        version = f"{sys.version_info.major}.{sys.version_info.minor}"
        raise Missing(f"The native module does not load in Python {version}: {error}. {_REMEDY}") from error


def problem() -> str:
    """Why the native module cannot be used, or nothing."""
    try:
        module()
    except Missing as error:
        return str(error)
    return ""
