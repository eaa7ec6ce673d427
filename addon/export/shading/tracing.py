# SPDX-License-Identifier: GPL-3.0-or-later
"""Fields as steps of numbers: the formulas that NumPy evaluates for many cells are run once, on symbols.

A symbol stands for one number, and arrays of them have n = 1 where those formulas have n cells. NumPy itself does the
indexing, stacking and broadcasting of arrays of objects; what it would calculate makes new symbols here.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]


class Symbol:
    """A number: what operation it comes from, what that takes besides, and the symbols that it is done to."""

    __slots__ = ("inputs", "key", "operation", "setting")

    def __init__(self, operation: str, setting: Any, inputs: tuple[Symbol, ...]) -> None:
        self.operation, self.setting, self.inputs = operation, setting, inputs

    @property
    def value(self) -> float | None:
        return float(self.setting) if self.operation == "constant" else None


class Symbols:
    """All symbols of one program, of which equal ones are one."""

    def __init__(self) -> None:
        self._known: dict[tuple[Any, ...], Symbol] = {}

    def of(self, operation: str, *inputs: Symbol, setting: Any = 0) -> Symbol:
        key = operation, setting, *(id(one) for one in inputs)
        found = self._known.get(key)
        if found is None:
            found = self._known[key] = Symbol(operation, setting, inputs)
        return found

    def constant(self, value: float) -> Symbol:
        sound = float(np.clip(np.nan_to_num(value), -1e30, 1e30))
        return self.of("constant", setting=sound)

    def array(self, values: Any) -> Traced:
        """Of numbers, or of symbols and numbers."""
        plain = np.asarray(values, dtype=object)
        out = np.empty(plain.shape, dtype=object)
        for index, value in np.ndenumerate(plain):
            out[index] = value if isinstance(value, Symbol) else self.constant(float(value))
        made = out.view(Traced)
        made.symbols = self
        return made

    def done(self, name: str, *inputs: Symbol) -> Symbol:
        """A ufunc of NumPy's."""
        known = [one.value for one in inputs]
        if all(value is not None for value in known):
            with np.errstate(all="ignore"):
                return self.constant(float(getattr(np, name)(*known)))
        if name in _SAME:
            return self._simpler(_SAME[name], *inputs)
        composed = _COMPOSED.get(name)
        if composed is None:
            raise NotImplementedError(f"no step does what NumPy's {name} does")
        made: Symbol = composed(self, *inputs)
        return made

    def _simpler(self, operation: str, *inputs: Symbol) -> Symbol:
        """Without what changes nothing."""
        if len(inputs) == 2:
            a, b = inputs
            if operation == "multiply" and 0.0 in (a.value, b.value):
                return self.constant(0.0)
            if (operation, b.value) in {("multiply", 1.0), ("divide", 1.0), ("add", 0.0), ("subtract", 0.0)}:
                return a
            if (operation, a.value) in {("multiply", 1.0), ("add", 0.0)}:
                return b
            if operation == "power" and b.value == 2.0:
                return self.of("multiply", a, a)
            if operation == "power" and b.value == 3.0:
                return self.of("multiply", self.of("multiply", a, a), a)
            if operation == "power" and b.value == 4.0:
                square = self.of("multiply", a, a)
                return self.of("multiply", square, square)
        return self.of(operation, *inputs)

    def in_table(self, entries: tuple[float, ...], at: Any, stepped: bool = False) -> Traced:
        """(n,) of places in [0, 1] among equally distant entries."""
        operation = "stepped table" if stepped else "table"
        of = np.frompyfunc(lambda one: self.of(operation, one, setting=entries), 1, 1)
        return self.array(of(self.array(at).view(np.ndarray)))

    def chosen(self, condition: Symbol, a: Symbol, b: Symbol) -> Symbol:
        if condition.value is not None:
            return a if condition.value else b
        return a if a is b else self.of("select", condition, a, b)


# NumPy's names, and those of the steps that do the same.
_SAME = {
    "add": "add", "subtract": "subtract", "multiply": "multiply", "divide": "divide", "true_divide": "divide",
    "minimum": "minimum", "maximum": "maximum", "power": "power", "floor": "floor", "ceil": "ceil",
    "trunc": "truncate", "sqrt": "square root", "absolute": "absolute", "sign": "sign", "exp": "exponent",
    "log": "logarithm", "sin": "sine", "cos": "cosine", "arctan2": "arc tangent", "less": "less", "equal": "equal",
}  # fmt: skip


def _not(symbols: Symbols, a: Symbol) -> Symbol:
    return symbols.done("subtract", symbols.constant(1.0), a)


def _remainder(symbols: Symbols, a: Symbol, b: Symbol) -> Symbol:
    whole = symbols.done("floor", symbols.done("divide", a, b))
    return symbols.done("subtract", a, symbols.done("multiply", whole, b))


def _fmod(symbols: Symbols, a: Symbol, b: Symbol) -> Symbol:
    whole = symbols.done("trunc", symbols.done("divide", a, b))
    return symbols.done("subtract", a, symbols.done("multiply", whole, b))


def _tangent(symbols: Symbols, a: Symbol) -> Symbol:
    return symbols.done("divide", symbols.done("sin", a), symbols.done("cos", a))


def _arc_sine(symbols: Symbols, a: Symbol) -> Symbol:
    rest = symbols.done("sqrt", symbols.done("subtract", symbols.constant(1.0), symbols.done("multiply", a, a)))
    return symbols.done("arctan2", a, rest)


def _arc_cosine(symbols: Symbols, a: Symbol) -> Symbol:
    return symbols.done("subtract", symbols.constant(0.5 * math.pi), _arc_sine(symbols, a))


def _hyperbolic(symbols: Symbols, a: Symbol, sign: float) -> Symbol:
    up, down = symbols.done("exp", a), symbols.done("exp", symbols.done("negative", a))
    both = symbols.done("add", up, symbols.done("multiply", symbols.constant(sign), down))
    return symbols.done("multiply", symbols.constant(0.5), both)


def _scaled(factor: float) -> Callable[[Symbols, Symbol], Symbol]:
    return lambda symbols, a: symbols.done("multiply", a, symbols.constant(factor))


_COMPOSED: dict[str, Callable[..., Any]] = {
    "negative": _scaled(-1.0),
    "greater": lambda symbols, a, b: symbols.done("less", b, a),
    "less_equal": lambda symbols, a, b: _not(symbols, symbols.done("less", b, a)),
    "greater_equal": lambda symbols, a, b: _not(symbols, symbols.done("less", a, b)),
    "not_equal": lambda symbols, a, b: _not(symbols, symbols.done("equal", a, b)),
    "bitwise_and": lambda symbols, a, b: symbols.done("multiply", a, b),
    "bitwise_or": lambda symbols, a, b: symbols.done("maximum", a, b),
    "invert": _not,
    "square": lambda symbols, a: symbols.done("multiply", a, a),
    "remainder": _remainder,
    "fmod": _fmod,
    "tan": _tangent,
    "arcsin": _arc_sine,
    "arccos": _arc_cosine,
    "arctan": lambda symbols, a: symbols.done("arctan2", a, symbols.constant(1.0)),
    "sinh": lambda symbols, a: _hyperbolic(symbols, a, -1.0),
    "cosh": lambda symbols, a: _hyperbolic(symbols, a, 1.0),
    "tanh": lambda symbols, a: symbols.done("divide", _hyperbolic(symbols, a, -1.0), _hyperbolic(symbols, a, 1.0)),
    "radians": _scaled(math.pi / 180.0),
    "degrees": _scaled(180.0 / math.pi),
}


class Traced(np.ndarray[Any, Any]):
    """An array of symbols."""

    symbols: Symbols

    def __array_finalize__(self, source: Any) -> None:
        self.symbols = getattr(source, "symbols", None)  # type: ignore[assignment]

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **settings: Any) -> Any:
        symbols = _symbols_of(inputs)
        arrays = [symbols.array(each).view(np.ndarray) for each in inputs]
        name = ufunc.__name__
        if method == "reduce":
            axis = settings.get("axis", 0)
            parts = [np.take(arrays[0], [i], axis=axis) for i in range(arrays[0].shape[axis])]
            once = np.frompyfunc(functools.partial(symbols.done, name), 2, 1)
            found = functools.reduce(once, parts)
            return symbols.array(found if settings.get("keepdims", False) else np.squeeze(found, axis=axis))
        if method != "__call__":
            return NotImplemented
        if name == "matmul":  # of rows by a vector
            return np.add.reduce(symbols.array(arrays[0]) * symbols.array(arrays[1]), axis=1)
        each = np.frompyfunc(functools.partial(symbols.done, name), len(arrays), 1)
        return symbols.array(each(*arrays))

    def __array_function__(self, function: Any, types: Any, inputs: Any, settings: Any) -> Any:
        made = _FUNCTIONS.get(function)
        if made is not None:
            return made(*inputs, **settings)
        symbols = _symbols_of(inputs)
        plain = _each_plain(inputs, symbols), {name: _each_plain(each, symbols) for name, each in settings.items()}
        found = function(*plain[0], **plain[1])
        if isinstance(found, (list, tuple)):
            return [symbols.array(each) for each in found]
        return symbols.array(found) if isinstance(found, np.ndarray) and found.dtype == object else found


def _symbols_of(inputs: Any) -> Symbols:
    for each in inputs:
        if isinstance(each, Traced):
            return each.symbols
        if isinstance(each, (list, tuple)) and any(isinstance(one, (Traced, list, tuple)) for one in each):
            try:
                return _symbols_of(each)
            except LookupError:
                continue
    raise LookupError("no traced array")


def _each_plain(value: Any, symbols: Symbols) -> Any:
    if isinstance(value, (list, tuple)):
        return type(value)(_each_plain(each, symbols) for each in value)
    if isinstance(value, np.ndarray):
        return symbols.array(value).view(np.ndarray)
    return value


def _where(condition: Any, a: Any, b: Any) -> Traced:
    symbols = _symbols_of((condition, a, b))
    arrays = [symbols.array(each).view(np.ndarray) for each in (condition, a, b)]
    return symbols.array(np.frompyfunc(symbols.chosen, 3, 1)(*arrays))


def _norm(v: Any, axis: int) -> Any:
    return np.sqrt((v * v).sum(axis=axis))


def _cross(a: Any, b: Any) -> Any:
    turned = [a[:, (k + 1) % 3] * b[:, (k + 2) % 3] - a[:, (k + 2) % 3] * b[:, (k + 1) % 3] for k in range(3)]
    return np.stack(turned, axis=1)


def _interpolated(at: Any, places: Array, values: Array) -> Any:
    """Linear between places that need not be equally far apart: by a table of ones that are."""
    even = np.linspace(places[0], places[-1], 1024)
    return at.symbols.in_table(tuple(np.interp(even, places, values)), (at - even[0]) / (even[-1] - even[0]))


def _mean(v: Any, axis: int) -> Any:
    return v.sum(axis=axis) * (1.0 / v.shape[axis])


_FUNCTIONS: dict[Any, Callable[..., Any]] = {
    np.where: _where,
    np.clip: lambda a, low, high: np.minimum(np.maximum(a, low), high),
    np.linalg.norm: _norm,
    np.cross: _cross,
    np.interp: _interpolated,
    np.mean: _mean,
    np.sum: lambda a, axis: np.add.reduce(a, axis=axis),
    np.nan_to_num: lambda a, **_: a,
}
