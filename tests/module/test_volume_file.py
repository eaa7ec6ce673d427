# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that read_volume refuses, from Python; tests/native/scene/volume_file_test.cpp writes the odder ones."""

from __future__ import annotations

from pathlib import Path

import pytest
import sfumato

FIRE = Path(__file__).resolve().parents[2] / "blend_samples" / "frames" / "fire.vdb"


def refusal(path: Path, grid: str = "density") -> str:
    with pytest.raises(ValueError) as refused:
        sfumato.read_volume(str(path), grid)
    start = f"path '{path}' cannot be read: "
    assert str(refused.value).startswith(start)
    return str(refused.value)[len(start) :]


def test_what_is_no_volume_is_named(tmp_path: Path) -> None:
    assert refusal(tmp_path / "missing.vdb") == "there is no such file"
    assert refusal(tmp_path) == "it is a directory"
    text = tmp_path / "text.vdb"
    text.write_text("")
    assert refusal(text) == "it is empty"
    text.write_text("Smoke simulates air, and air simulates nothing.")
    assert refusal(text) == "it is no OpenVDB file"


def test_grids_that_there_are_are_listed() -> None:
    assert refusal(FIRE, "temperature") == "it has no grid 'temperature', but 'density'"


@pytest.mark.parametrize("share", [0.0001, 0.001, 0.3, 0.999])
def test_files_cut_short_are_refused(tmp_path: Path, share: float) -> None:
    whole = FIRE.read_bytes()
    short = tmp_path / "short.vdb"
    short.write_bytes(whole[: int(share * len(whole))])
    assert "cut short" in refusal(short)


def test_a_whole_file_is_read() -> None:
    density, grid_to_object = sfumato.read_volume(str(FIRE))
    assert density.shape == (62, 56, 62) and density.min() >= 0.0
    assert grid_to_object.shape == (4, 4) and (grid_to_object[3] == (0, 0, 0, 1)).all()
