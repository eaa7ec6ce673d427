# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that read_volume refuses, from Python; tests/native/scene/volume_file_test.cpp writes the odder ones."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sfumato

ROOT = Path(__file__).resolve().parents[2]
FIRE = ROOT / "blend_samples" / "frames" / "fire.vdb"
TINTED = ROOT / "tests" / "goldens" / "tinted_smoke.vdb"  # by make_tinted_smoke.cpp


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


def test_vectors_are_read_as_what_made_them() -> None:
    tint, grid_to_object = sfumato.read_volume(str(TINTED), "tint")
    assert tint.shape == (16, 16, 16, 3)
    z, _, x = np.indices(tint.shape[:3]) * grid_to_object[0, 0]
    assert np.allclose(tint, np.stack((0.5 * x, 1.0 - 0.5 * x, 0.5 * z), axis=3), atol=1e-3)  # halves


def trail(cells: int = 96) -> np.ndarray:
    """A diagonal row of cells, and nothing else."""
    density = np.zeros((cells, cells, cells), np.float32)
    density[np.arange(cells), np.arange(cells), np.arange(cells)] = 1.0
    return density


def picture(density: np.ndarray | sfumato.Grid, grid_to_world: np.ndarray) -> np.ndarray:
    scene = sfumato.Scene()
    scene.add_medium(density, grid_to_world, (2, 2, 2), (1, 1, 1))
    scene.add_sun((0.3, 0.5, -1), (4, 4, 4))
    return sfumato.Frame(scene).render(sfumato.Camera(np.diag([0.2, 0.2, -0.1, 1.0])), 32, 32)


def test_a_grid_from_a_file_is_that_of_its_array() -> None:
    density, grid_to_object = sfumato.read_volume(str(FIRE))
    shape, place = sfumato.volume_header(str(FIRE))
    assert shape == density.shape and (place == grid_to_object).all()
    empty_below = sfumato.emptiness(shape, place, (3, 3, 3))
    grid = sfumato.Grid.from_file(str(FIRE), empty_below=empty_below)
    assert grid.amount == pytest.approx(density[density > empty_below].sum(dtype=float), rel=1e-6)
    assert grid.cells == sfumato.Grid(density, empty_below).cells
    rendered = picture(grid, place)
    assert rendered[..., 3].max() > 0.1  # there is something to see
    assert np.abs(rendered - picture(density, place)).max() < 1e-6


def test_grids_from_files_are_refused_as_their_arrays_are(tmp_path: Path) -> None:
    readers: list[Callable[..., Any]] = [sfumato.volume_header, sfumato.Grid.from_file]
    for read in readers:
        with pytest.raises(ValueError, match="it has no grid 'heat', but 'density'"):
            read(str(FIRE), "heat")
        with pytest.raises(ValueError, match=f"path '{tmp_path}' cannot be read: it is a directory"):
            read(str(tmp_path))
    with pytest.raises(ValueError, match="empty_below"):
        sfumato.Grid.from_file(str(FIRE), empty_below=float("nan"))


def test_what_is_mostly_empty_takes_few_cells_and_is_given_whole() -> None:
    density = trail()
    grid = sfumato.Grid(density)
    assert 0 < grid.cells < 0.1 * density.size
    scene = sfumato.Scene()
    scene.add_medium(grid, np.eye(4), (1, 1, 1), (0, 0, 0))
    scene.add_sun((0, 0, -1), (4, 4, 4))
    medium = sfumato.Frame(scene).media[0]
    assert (medium.density[1:-1, 1:-1, 1:-1] == density).all()
    assert medium.density.sum() == density.sum()
    diagonal = medium.light[0][1:-1, 1:-1, 1:-1][density > 0]
    assert (diagonal[:, 1] == 1.0).all()  # no solid is in the way
