# SPDX-License-Identifier: GPL-3.0-or-later
"""What smoke emits: the same everywhere, or by the values of one grid. By several, it is calculated cell by cell."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from .shading import fields
from .shading.fields import Field

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Emitter:
    """What glows by the values of one grid: of those, radiance per metre, W/(m^3 sr). Without an attribute it is the same
    wherever there is smoke."""

    attribute: str
    radiance: Field
    scale: float = 1.0

    def of(self, values: Array) -> Array:
        """(n, 3) of values (n,); not negative, and the same below 0 as at 0."""
        (found,) = fields.evaluate([self.radiance], {self.attribute: np.maximum(values, 0.0)})
        return np.repeat(self._shown(found), 1 if len(found) > 1 else len(values), axis=0)

    def everywhere(self) -> Emitter:
        """The same where the grid is not there."""
        (found,) = fields.evaluate([self.radiance], {})
        return Emitter("", fields.constant(self._shown(found)[0]))

    def _shown(self, radiance: Array) -> Array:
        return np.asarray(np.maximum(radiance * self.scale, 0.0))


def emitters_of(glows: Iterable[Field], scale: float) -> tuple[Emitter, ...]:
    """Of what is emitted by one grid each, or by none."""
    return tuple(Emitter(next(iter(glow.attributes), ""), glow, scale) for glow in glows)


def merged(emitters: Iterable[Emitter]) -> tuple[Emitter, ...]:
    """Those of the same grid as one."""
    out: dict[str, Emitter] = {}
    for emitter in emitters:
        known = out.get(emitter.attribute)
        out[emitter.attribute] = emitter if known is None else _sum(known, emitter)
    return tuple(out.values())


def _sum(a: Emitter, b: Emitter) -> Emitter:
    share = fields.constant(b.scale / a.scale)
    other = b.radiance if a.scale == b.scale else fields.of("scaled", share, b.radiance)
    return replace(a, radiance=fields.of("each", a.radiance, other, settings=("sum",)))
