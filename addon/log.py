# SPDX-License-Identifier: GPL-3.0-or-later
"""What an artist should know: kept for the panels, printed once each."""

from __future__ import annotations

_notices: dict[str, list[str]] = {}
_stages: dict[str, float] = {}


def replace(source: str, notices: list[str]) -> None:
    """What `source` ("render", "viewport", ...) has to say now. Only what is new goes to the terminal."""
    known = {line for lines in _notices.values() for line in lines}
    unique = list(dict.fromkeys(notices))
    for line in unique:
        if line not in known:
            print(f"Sfumato: {line}")
    _notices[source] = unique


def notices() -> list[str]:
    """All that is being said, each line once."""
    return list(dict.fromkeys(line for lines in _notices.values() for line in lines))


def clear() -> None:
    """Forget everything: another file was opened, or the add-on is going."""
    _notices.clear()
    _stages.clear()


def took(stages: dict[str, float]) -> None:
    """Frame.stages of what was last drawn or rendered."""
    _stages.clear()
    _stages.update(stages)


def metadata(quality: str) -> dict[str, str]:
    """What a picture's file says of how it was made."""
    times = ", ".join(f"{name} {seconds:.3f} s" for name, seconds in _stages.items())
    return {"Sfumato quality": quality.capitalize(), "Sfumato stages": times}


def stages() -> dict[str, float]:
    return _stages
