# SPDX-License-Identifier: GPL-3.0-or-later
"""sfumato.pyi says what the built module says."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import pytest
import sfumato

ROOM = Path(__file__).resolve().parents[2] / "native" / "module"


def written(module: object) -> str:
    spec = importlib.util.spec_from_file_location("stub", ROOM / "stub.py")
    assert spec is not None and spec.loader is not None
    generator = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(generator)
    text: str = generator.stub(module)
    return text


def test_the_stub_is_the_modules() -> None:
    if "numpy.ndarray[numpy.float64]" not in (sfumato.Camera.__init__.__doc__ or ""):
        pytest.skip("this pybind11 writes signatures in another way")
    assert (ROOM / "sfumato.pyi").read_text(encoding="utf-8") == written(
        sfumato
    ), "run: cmake --build build --target stub"
