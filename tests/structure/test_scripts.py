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


# Rounds within rounds: one of three tests fails in the inner one, with its reason.
ROUNDS = """
source tests/setup.sh
build=$1/${2-outer}
inner() { printf 'passed test_a (0.1 s)\\nValueError: the reason\\nfailed test_b (0.1 s)\\n1 passed, 1 failed, 0 skipped\\n'; return 1; }
middle() { run_counted inner 60 bash "$0" "$build" inner; summary; }
if [[ ${2-} ]]; then "$2"; exit; fi
run_counted middle 60 bash "$0" "$1" middle
summary
"""


def test_what_failed_is_named_once_more_at_the_end(tmp_path: Path) -> None:
    script = tmp_path / "rounds.sh"
    script.write_text(ROUNDS, encoding="utf-8")
    command = ["bash", str(script), str(tmp_path)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    end = done.stdout.split("== failed\n")[-1].splitlines()
    assert end[-1] == "1 passed, 1 failed, 0 skipped"
    assert [line for line in end if line.startswith("In ")] == ["In middle:", "In inner:"]
    assert end.count("failed test_b (0.1 s)") == end.count("ValueError: the reason") == 1


def test_failures_that_were_expected_count_as_passed(tmp_path: Path) -> None:
    said = "==== 3 passed, 2 xfailed, 1 skipped in 0.1s ===="
    script = f"source tests/setup.sh; build={tmp_path}; run_counted some 60 echo '{said}'; summary"
    done = subprocess.run(["bash", "-euc", script], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.stdout.splitlines()[-1] == "5 passed, 0 failed, 1 skipped"
