# SPDX-License-Identifier: GPL-3.0-or-later
"""What an artist should know: kept for the panels, printed once each.

A notice is a line, "NAME: sentence". What is said of many things is said once of them all.
"""

from __future__ import annotations

import functools
import re
from dataclasses import dataclass

NAMES_PRINTED = 5
_NOT_OBJECTS = {"'": "files", "View layer": "view layers"}  # how names begin that are not those of objects
_NUMBER = re.compile(r"(?<![\w.'])-?\d+(?:\.\d+)?(?![\w']|\.\d)")

_notices: dict[str, list[str]] = {}
_stages: dict[str, float] = {}


@dataclass(frozen=True)
class Group:
    """What is said of one thing, or of many: "2 objects: its Shadow is off, but it casts one"."""

    sentence: str
    names: tuple[str, ...]  # none where a line names nothing

    def __str__(self) -> str:
        return ": ".join([*self._whom(), self.sentence])

    def _whom(self) -> list[str]:
        if len(self.names) < 2:
            return list(self.names)
        others = [kind for start, kind in _NOT_OBJECTS.items() if self.names[0].startswith(start)]
        return [f"{len(self.names)} {others[0] if others else 'objects'}"]

    def printed(self) -> str:
        """As in the terminal, where nothing can be asked for: with the first of many names."""
        if len(self.names) < 2:
            return str(self)
        listed = ", ".join(self.names[:NAMES_PRINTED])
        more = len(self.names) - NAMES_PRINTED
        return f"{self} ({listed}{f' and {more} more' if more > 0 else ''})"


@functools.lru_cache(maxsize=8)  # panels ask at every redraw
def grouped(lines: tuple[str, ...]) -> list[Group]:
    """The lines that say the same, in the order of the first of each. Numbers in which they differ become a range:
    "Transmission of 0.2 to 0.9"."""
    alike: dict[str, tuple[list[str], list[str]]] = {}
    for line in lines:
        name, colon, sentence = line.partition(": ")
        if not colon:
            name, sentence = "", line
        names, sentences = alike.setdefault(_NUMBER.sub("#", sentence), ([], []))
        names.append(name)
        sentences.append(sentence)
    return [
        Group(_ranging(sentences), tuple(dict.fromkeys(name for name in names if name)))
        for names, sentences in alike.values()
    ]


def _ranging(sentences: list[str]) -> str:
    """One sentence for all that differ in numbers alone."""
    columns = iter([sorted(set(column), key=float) for column in zip(*map(_NUMBER.findall, sentences))])

    def span(_: re.Match[str]) -> str:
        values: list[str] = next(columns)
        return values[0] if len(values) == 1 else f"{values[0]} to {values[-1]}"

    return _NUMBER.sub(span, sentences[0])


def replace(source: str, notices: list[str]) -> None:
    """What `source` ("render", "viewport", ...) has to say now. Only what is new goes to the terminal."""
    known = {line for lines in _notices.values() for line in lines}
    unique = list(dict.fromkeys(notices))
    for group in grouped(tuple(line for line in unique if line not in known)):
        print(f"Sfumato: {group.printed()}")
    _notices[source] = unique


def notices(*sources: str) -> list[str]:
    """All that is being said, by these or by all, each line once."""
    said = (_notices.get(source, []) for source in sources or _notices)
    return list(dict.fromkeys(line for lines in said for line in lines))


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
