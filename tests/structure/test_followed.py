# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of what is followed says what the add-on's tables do."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def test_the_page_is_that_of_the_tables() -> None:
    made = subprocess.run([sys.executable, ROOT / "docs" / "followed.py"], capture_output=True, text=True, check=True)
    assert made.stdout == (ROOT / "docs" / "followed.md").read_text(encoding="utf-8"), "see docs/followed.py"
