# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures that can be read whole and those that cannot, from Python; the native test has each format."""

from __future__ import annotations

from pathlib import Path

import pytest
import sfumato

ROOT = Path(__file__).resolve().parents[2]
EXR = ROOT / "tests" / "goldens" / "plume_cycles.exr"
PNG = ROOT / "docs" / "cost.png"


@pytest.mark.parametrize("picture", [EXR, PNG], ids=lambda path: str(path.suffix))
def test_whole_pictures_and_parts_of_them(picture: Path, tmp_path: Path) -> None:
    assert sfumato.unreadable_picture(str(picture)) is None
    part = tmp_path / f"Rauch über Öl{picture.suffix}"
    for share in (0.0, 0.001, 0.5, 0.99):
        data = picture.read_bytes()
        part.write_bytes(data[: int(share * len(data))])
        reason = sfumato.unreadable_picture(str(part))
        assert reason and reason.startswith(f"'{part}' cannot be read whole: "), reason
        assert share > 0 or reason.endswith("it is empty")


def test_what_is_no_picture_is_named(tmp_path: Path) -> None:
    text = tmp_path / "text.png"
    text.write_text("Smoke simulates air, and air simulates nothing.")
    assert (sfumato.unreadable_picture(str(text)) or "").startswith(f"'{text}' cannot be read whole: ")
