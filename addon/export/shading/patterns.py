# SPDX-License-Identifier: GPL-3.0-or-later
"""Fields of surfaces as native patterns: what a program is made of."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import fields, procedural, ramps, relief
from .fields import Field
from .tracing import Symbol, Symbols, Traced

STANDS_FOR = "stands for"  # the width of what a sample is a mean of, pixels
HERE, ALONG, ACROSS = 0, 1, 2  # a point, and a pixel further along two axes
REGISTERS = 256
STEP_INPUTS = 10

# Of an input, by its name and output, and where it is asked for: an array of symbols.
Inputs = Callable[[Symbols, str, str, float, int], Any]


class TooLarge(Exception):
    """A program takes more registers than there are."""


class Tracer:
    """Makes symbols of fields, of each once."""

    def __init__(self, inputs: Inputs) -> None:
        self.symbols = Symbols()
        self._inputs = inputs
        self._known: dict[tuple[bytes, int], Traced] = {}

    def traced(self, wanted: Field, where: int = HERE) -> Traced:
        """(1,) of a number, (1, 3) of a colour or a vector."""
        key = wanted.digest, where
        if key not in self._known:
            self._known[key] = self.symbols.array(self._made(wanted, where))
        return self._known[key]

    def _made(self, wanted: Field, where: int) -> Any:
        constant = wanted.constant
        if constant is not None:
            return constant
        if wanted.operation == fields.GRID:
            name, output, absent = wanted.settings
            return self._inputs(self.symbols, name, output, absent, where)
        special = SPECIAL.get(wanted.operation)
        if special is not None:
            return special(self, wanted, where)
        inputs = [self.traced(each, where) for each in wanted.inputs]
        return fields.OPERATIONS[wanted.operation](*wanted.settings, *inputs)


def _ramp(tracer: Tracer, wanted: Field, where: int) -> Any:
    """Of 256 entries, as Cycles has it."""
    at = tracer.traced(wanted.inputs[0], where)
    entries = ramps.OPERATIONS[wanted.operation](*wanted.settings, np.linspace(0.0, 1.0, 256))
    stepped = wanted.settings[0] == "CONSTANT" and wanted.settings[1] == "RGB"
    columns = entries[:, None] if entries.ndim == 1 else entries
    found = [tracer.symbols.in_table(tuple(column), at, stepped) for column in columns.T]
    return found[0] if entries.ndim == 1 else np.stack(found, axis=1)


def _image(tracer: Tracer, wanted: Field, where: int) -> Any:
    """The mean over a pixel: by how far its place on the image moves with the pixel's axes."""
    places = [tracer.traced(wanted.inputs[0], each) for each in (HERE, ALONG, ACROSS)]
    wide = tracer.traced(fields.grid(STANDS_FOR, "Fac"))[:, None]
    steps = [(places[each] - places[HERE]) * wide for each in (ALONG, ACROSS)]
    texels, *how = wanted.settings

    def looked_up(one: Any, at: Any) -> Any:
        numbers = [each[0, k] for each in (at, *steps) for k in (0, 1)]
        whole = tracer.symbols.of("image", *numbers, setting=(one, *how))
        return tracer.symbols.array([[tracer.symbols.of("part", whole, setting=k) for k in range(4)]])

    if texels.tiles:
        found: Any = np.array([(1.0, 0.0, 1.0, 1.0)])  # where there is no tile
        whole_place = np.trunc(places[where])
        for number, tile in texels.tiles.items():
            column, row = (number - 1001) % 10, (number - 1001) // 10
            inside = (whole_place[:, 0] == float(column)) & (whole_place[:, 1] == float(row))
            parts = looked_up(tile, places[where] - np.array((float(column), float(row), 0.0)))
            found = np.where(inside[:, None], parts, found)
    else:
        found = looked_up(texels, places[where])
    return found[:, 3] if wanted.operation == "image's alpha" else found[:, :3]


def _bump(tracer: Tracer, wanted: Field, where: int) -> Any:
    height, strength, distance, normal, position = wanted.inputs
    heights = [tracer.traced(height, each) for each in (HERE, ALONG, ACROSS)]
    here, along, across = (tracer.traced(position, each) for each in (HERE, ALONG, ACROSS))
    rest = [tracer.traced(each, where) for each in (strength, distance, normal)]
    return relief.bumped((heights[0], heights[1], heights[2]), (along - here, across - here), *rest)


def _texture(tracer: Tracer, wanted: Field, where: int) -> Any:
    name, integers, first, count = wanted.settings
    numbers = [one for each in wanted.inputs for one in tracer.traced(each, where).ravel()]
    whole = tracer.symbols.of(name, *numbers, setting=integers)
    width = _WIDTHS[name]
    parts = [tracer.symbols.of("part", whole, setting=first + k) if width > 1 else whole for k in range(count)]
    return [parts] if count > 1 else parts


SPECIAL: dict[str, Callable[[Tracer, Field, int], Any]] = {
    "texture": _texture,
    "ramp's colour": _ramp,
    "ramp's alpha": _ramp,
    "image's colour": _image,
    "image's alpha": _image,
    "bump": _bump,
}


@dataclass
class Program:
    """What a native Pattern is made of."""

    steps: NDArray[np.float64]  # (n, 13)
    outputs: NDArray[np.float64]  # (k, 2): slots and registers
    constants: NDArray[np.float32] = field(default_factory=lambda: np.zeros(0, np.float32))
    tables: list[NDArray[np.float32]] = field(default_factory=list)
    integers: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 6)))
    images: list[tuple[Any, str, str]] = field(default_factory=list)  # texels, interpolation, extension


# How many registers an operation writes, where it is not one.
_WIDTHS: dict[str, int] = {"image": 4, **procedural.OUTPUTS}


def program_of(wanted: Mapping[int, Symbol], operations: Sequence[str]) -> Program:
    """The steps to what is wanted, by slots, in the numbers that `operations` have. Raises TooLarge."""
    order = _ordered(list(wanted.values()))
    last_use: dict[Symbol, int] = {}
    for number, symbol in enumerate(order):
        for one in symbol.inputs:
            last_use[_written(one)] = number
    for symbol in wanted.values():
        last_use[_written(symbol)] = len(order)
    registers = _Registers()
    codes = {name: number for number, name in enumerate(operations)}
    constants: dict[float, int] = {}
    tables: dict[tuple[float, ...], int] = {}
    integers: dict[tuple[int, ...], int] = {}
    images: dict[tuple[Any, str, str], int] = {}
    steps: list[list[float]] = []
    for number, symbol in enumerate(order):
        if symbol.operation == "part":
            continue
        setting, inputs = symbol.setting, [registers.of(one) for one in symbol.inputs]
        if symbol.operation == "constant":
            setting = constants.setdefault(setting, len(constants))
        elif symbol.operation == "input":
            setting, where = symbol.setting
            inputs = [where]
        elif symbol.operation in {"table", "stepped table"}:
            setting = tables.setdefault(setting, len(tables))
        elif symbol.operation in procedural.OUTPUTS:
            setting = integers.setdefault(setting, len(integers))
        elif symbol.operation == "image":
            setting = images.setdefault(setting, len(images))
        for one in symbol.inputs:
            if last_use[_written(one)] == number:
                registers.free(_written(one))
        to = registers.take(symbol)
        steps.append([codes[symbol.operation], to, setting, *inputs, *[0] * (STEP_INPUTS - len(inputs))])
    outputs = [(slot, registers.of(symbol)) for slot, symbol in wanted.items()]
    return Program(
        np.array(steps, np.float64).reshape(-1, 3 + STEP_INPUTS),
        np.array(outputs, np.float64).reshape(-1, 2),
        np.array(list(constants), np.float32),
        [np.array(entries, np.float32) for entries in tables],
        np.array(list(integers), np.float64).reshape(-1, 6),
        list(images),
    )


def _written(symbol: Symbol) -> Symbol:
    """What a step writes: of a part, the whole."""
    return symbol.inputs[0] if symbol.operation == "part" else symbol


def _ordered(wanted: list[Symbol]) -> list[Symbol]:
    """Each after what it needs, and soon after."""
    done: dict[Symbol, None] = {}
    waiting: list[tuple[Symbol, bool]] = [(symbol, False) for symbol in reversed(wanted)]
    while waiting:
        symbol, ready = waiting.pop()
        if symbol in done:
            continue
        if ready:
            done[symbol] = None
            continue
        waiting.append((symbol, True))
        waiting += [(one, False) for one in reversed(symbol.inputs) if one not in done]
    return list(done)


class _Registers:
    """Which are taken, and by what."""

    def __init__(self) -> None:
        self._taken = [False] * REGISTERS
        self._first: dict[Symbol, int] = {}

    def take(self, symbol: Symbol) -> int:
        width = _WIDTHS.get(symbol.operation, 1)
        run = 0
        for number, taken in enumerate(self._taken):
            run = 0 if taken else run + 1
            if run == width:
                first = number - width + 1
                self._taken[first : number + 1] = [True] * width
                self._first[symbol] = first
                return first
        raise TooLarge

    def of(self, symbol: Symbol) -> int:
        return self._first[_written(symbol)] + (int(symbol.setting) if symbol.operation == "part" else 0)

    def free(self, symbol: Symbol) -> None:
        first = self._first[symbol]
        width = _WIDTHS.get(symbol.operation, 1)
        self._taken[first : first + width] = [False] * width
