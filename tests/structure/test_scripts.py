# SPDX-License-Identifier: GPL-3.0-or-later
"""What the scripts promise: a cache that holds nothing half made, and a filter that says when it matches nothing."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
# Fills the folder that it is given, slowly, and notes that it did.
MAKE = """
source tests/setup.sh
make() { echo made >>"$notes" && sleep 0.3 && echo whole >"$1/content" && [[ ! -e $notes.fail ]]; }
cached thing "$1" make && cat "$cached/content"
"""


def cached(home: Path, recipe: str = "flour") -> subprocess.Popen[str]:
    return subprocess.Popen(
        ["bash", "-euc", MAKE, "test", recipe],
        cwd=ROOT,
        env=os.environ | {"XDG_CACHE_HOME": str(home), "notes": str(home / "notes")},
        stdout=subprocess.PIPE,
        text=True,
    )


def times_made(home: Path) -> int:
    return len((home / "notes").read_text(encoding="utf-8").splitlines())


def test_what_is_cached_is_made_once(tmp_path: Path) -> None:
    both = [cached(tmp_path), cached(tmp_path)]
    assert [process.communicate(timeout=60)[0] for process in both] == ["whole\n"] * 2
    assert cached(tmp_path).communicate(timeout=60)[0] == "whole\n"
    assert times_made(tmp_path) == 1
    assert cached(tmp_path, "another flour").communicate(timeout=60)[0] == "whole\n"
    assert times_made(tmp_path) == 2


def test_what_was_stopped_half_made_is_made_anew(tmp_path: Path) -> None:
    (tmp_path / "notes.fail").touch()
    failed = cached(tmp_path)
    assert failed.communicate(timeout=60)[0] == "" and failed.returncode != 0
    (tmp_path / "notes.fail").unlink()
    (part,) = (tmp_path / "sfumato").glob("thing-*.part")
    (part / "litter").touch()
    assert cached(tmp_path).communicate(timeout=60)[0] == "whole\n"
    (place,) = (path for path in (tmp_path / "sfumato").glob("thing-*") if path.suffix == "")
    assert [path.name for path in place.iterdir()] == ["content"]


@pytest.mark.parametrize("pattern", ["no test is called this", "a[", "--unknown"])
def test_a_pattern_that_cannot_match_is_refused(pattern: str) -> None:
    done = subprocess.run([ROOT / "tests" / "run", pattern], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert pattern in done.stderr or "Usage" in done.stderr
    assert "Building" not in done.stdout


def test_a_pattern_runs_what_matches() -> None:
    done = subprocess.run([ROOT / "tests" / "run", "scene/camera"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout[-2000:]
    assert "== camera_test" in done.stdout and "== python" not in done.stdout
    passed = done.stdout.splitlines()[-1]
    assert passed.endswith("passed, 0 failed, 0 skipped") and int(passed.partition(" ")[0]) > 1
