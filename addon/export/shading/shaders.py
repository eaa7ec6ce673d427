# SPDX-License-Identifier: GPL-3.0-or-later
"""Volume shaders as fields: what a material makes of the space that it fills."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import compat
from .. import materials
from . import fields
from .fields import Field
from .reading import Place, Reader, Source


@dataclass(frozen=True)
class Body:
    """Coefficients per metre, colours, and the anisotropy, a number; or Rayleigh's phase function."""

    scattering: Field
    absorption: Field
    anisotropy: Field
    rayleigh: bool = False


@dataclass(frozen=True)
class Look:
    """What volume shaders add up to: `plain` where that is one density times constants, else `bodies`; and what they emit,
    W/(m^3 sr), by shader."""

    plain: materials.Smoke | None = None
    bodies: tuple[Body, ...] = ()
    emission: tuple[Field, ...] = ()

    @property
    def attributes(self) -> list[str]:
        """The grids that are asked for."""
        plain = [] if self.plain is None or not self.plain.extinction.any() else [self.plain.attribute]
        found = frozenset[str]().union(
            *(
                field.attributes
                for body in self.bodies
                for field in (body.scattering, body.absorption, body.anisotropy)
            ),
            *(field.attributes for field in self.emission),
        )
        return list(dict.fromkeys([*plain, *sorted(found)]))

    def everywhere(self) -> materials.Smoke:
        """Where there is no grid at all, per metre."""
        if self.plain is not None:
            return self.plain
        scattering, absorption, leaning = np.zeros(3), np.zeros(3), np.zeros(3)
        for body in self.bodies:
            s, a, g = fields.evaluate((body.scattering, body.absorption, body.anisotropy), {})
            scattering, absorption, leaning = scattering + s[0], absorption + a[0], leaning + g[0] * s[0]
        total = float(scattering.sum())
        return materials.Smoke(scattering, absorption, float(leaning.sum()) / total if total > 0.0 else 0.0, "")


def look_of(thing: Any, depsgraph: Any, notices: list[str]) -> Look | None:
    """How an object's smoke looks, by its first material that fills it; of a Volume object, by its first. None where
    Cycles shows nothing."""
    found = [material for material in materials.materials_of(thing, depsgraph) if material is not None]
    if thing.type == "VOLUME" and not found:
        return Look(materials.Smoke(np.full(3, 0.5), np.full(3, 0.5)))  # a Principled Volume as it comes
    for material in found[:1] if thing.type == "VOLUME" else found:
        look = of_material(material, thing.name, notices)
        if look is not None:
            return look
    if thing.type == "VOLUME":
        return None
    notices.append(f"{thing.name}: no volume in its material; shown as white smoke of density 1")
    return Look(_WHITE)


_WHITE = materials.Smoke(np.ones(3), np.zeros(3))


def of_material(material: Any, owner: str, notices: list[str]) -> Look | None:
    """None where nothing fills its volume."""
    output = materials.active_output(material)
    return None if output is None else of_output(output, owner, notices)


def of_output(output: Any, owner: str, notices: list[str], *, even: bool = False) -> Look | None:
    """What fills the volume of a node of output, a material's or a world's. Where it is the same everywhere Rayleigh's phase
    function can be shown, which is named else."""
    reader = Reader(owner, notices)
    found = [(source.place, weight) for source, weight in added(reader, Place(output), "Volume", fields.constant(1.0))]
    if not found:
        return None
    scatterers = [(place, weight) for place, weight in found if place.node.type != "EMISSION"]
    emission = tuple(glow for place, weight in found for glow in _emitted(reader, place, weight))
    if not scatterers:
        return Look(materials.Smoke(np.zeros(3), np.zeros(3)), emission=emission)
    plain = _plain(reader, scatterers)
    if plain is not None:
        return Look(plain, emission=emission)
    bodies = [_body(reader, place, weight, even) for place, weight in scatterers]
    shining = [body for body in bodies if not _is_black(body.scattering)]
    if len(shining) > 1 and not compat.phases_share_light():
        notices.append(
            f"{owner}: {len(shining)} of its shaders scatter light, each as much as all together in Cycles of this Blender; "
            "here, each its own"
        )
    grouped = _grouped([body for body in bodies if not _is_clear(body)])
    if len(grouped) > 1 and compat.phases_share_light() and not even:
        notices.append(
            f"{owner}: its shaders scatter by {len(grouped)} anisotropies, each in its own color; in Cycles, all colors are "
            "shared out among them alike"
        )
    return Look(bodies=grouped, emission=emission)


def _is_clear(body: Body) -> bool:
    return _is_black(body.scattering) and _is_black(body.absorption)


def _grouped(found: list[Body]) -> tuple[Body, ...]:
    """Those of the same phase function as one; what only absorbs, has any."""
    bodies: dict[tuple[bool, bytes], Body] = {}
    for body in sorted(found, key=lambda one: _is_black(one.scattering)):
        own = body.rayleigh, body.anisotropy.digest
        key = next(iter(bodies), own) if _is_black(body.scattering) else own
        known = bodies.get(key)
        bodies[key] = body if known is None else _sum(known, body)
    return tuple(bodies.values())


def _sum(a: Body, b: Body) -> Body:
    return Body(
        each_of("sum", a.scattering, b.scattering), each_of("sum", a.absorption, b.absorption), a.anisotropy, a.rayleigh
    )


def _is_black(colour: Field) -> bool:
    return colour.constant is not None and not colour.constant.any()


def added(reader: Reader, place: Place, identifier: str, weight: Field) -> Iterator[tuple[Source, Field]]:
    """The shaders whose sum an input is, and how much there is of each."""
    socket = place.input(identifier)
    source = None if socket is None else reader.source(place, socket)
    if source is None or not source.socket.is_output:
        return
    node = source.place.node
    if node.type == "ADD_SHADER":
        yield from added(reader, source.place, "Shader", weight)
        yield from added(reader, source.place, "Shader_001", weight)
    elif node.type == "MIX_SHADER":
        share = math_of("MINIMUM", not_negative(reader.value(source.place, "Fac")), fields.constant(1.0))
        yield from added(
            reader,
            source.place,
            "Shader",
            math_of("MULTIPLY", weight, math_of("SUBTRACT", fields.constant(1.0), share)),
        )
        yield from added(reader, source.place, "Shader_001", math_of("MULTIPLY", weight, share))
    else:
        yield source, weight


def math_of(operation: str, *numbers: Field) -> Field:
    return fields.of("math", *numbers, settings=(operation,))


def each_of(operation: str, *colours: Field) -> Field:
    return fields.of("each", *colours, settings=(operation,))


def not_negative(number: Field) -> Field:
    return math_of("MAXIMUM", number, fields.constant(0.0))


def _named_grid(place: Place, identifier: str, output: str = "Fac") -> Field:
    """The grid that a Principled Volume multiplies by; 1 where there is none."""
    name = place.node.inputs[identifier].default_value
    one = fields.constant((1.0, 1.0, 1.0) if output == "Color" else 1.0)
    return fields.grid(name, output, absent=1.0) if name else one


def _plain(reader: Reader, found: list[tuple[Place, Field]]) -> materials.Smoke | None:
    """Where smoke is one Principled Volume of constants; grids and their crops are native then."""
    (place, weight), *others = found
    if others or place.node.type != "PRINCIPLED_VOLUME" or not _is_one(weight):
        return None
    inputs = [reader.value(place, name) for name in ("Density", "Color", "Absorption Color", "Anisotropy")]
    density, colour, absorbed, anisotropy = (field.constant for field in inputs)
    attribute = place.node.inputs["Density Attribute"].default_value
    if density is None or colour is None or absorbed is None or anisotropy is None or not attribute:
        return None
    tint = place.node.inputs["Color Attribute"].default_value
    opaque: NDArray[np.float64] = np.maximum(absorbed[0], 0.0)
    shown: NDArray[np.float64] = np.maximum(colour[0], 0.0)
    if tint and (opaque.any() or shown.max() > 1.0):
        return None  # the tint is in the extinction, too
    amount = max(0.0, float(density[0]))
    absorption = amount * np.maximum(1.0 - shown, 0.0) * np.maximum(1.0 - np.sqrt(opaque), 0.0)
    return materials.Smoke(amount * shown, absorption, float(np.clip(anisotropy[0], -_MOST, _MOST)), attribute, tint)


def _is_one(weight: Field) -> bool:
    return weight.constant is not None and float(weight.constant[0]) == 1.0


_MOST = 0.999  # of an anisotropy


def _body(reader: Reader, place: Place, weight: Field, even: bool) -> Body:
    node = place.node
    coefficients = _coefficients(reader, place, weight, even)
    if even and getattr(node, "phase", "") == "RAYLEIGH":
        return Body(*coefficients, fields.constant(0.0), rayleigh=True)
    return Body(*coefficients, _anisotropy(reader, place))


def _coefficients(reader: Reader, place: Place, weight: Field, even: bool) -> tuple[Field, Field]:
    """What a shader scatters and what it absorbs."""
    node = place.node
    black = fields.constant((0.0, 0.0, 0.0))
    if node.type == "PRINCIPLED_VOLUME":
        density = _density(reader, place, weight)
        if density.constant is None or density.constant.any():
            density = not_negative(math_of("MULTIPLY", density, _named_grid(place, "Density Attribute")))
        tint = _named_grid(place, "Color Attribute", "Color")
        colour = each_of("not negative", each_of("product", reader.value(place, "Color"), tint))
        absorbed = each_of("rest", each_of("root", reader.value(place, "Absorption Color")))
        absorption = each_of("product", each_of("rest", colour), absorbed)
        return scaled(density, colour), scaled(density, absorption)
    if node.type in {"VOLUME_SCATTER", "VOLUME_ABSORPTION"}:
        density, colour = _density(reader, place, weight), reader.value(place, "Color")
        if node.type == "VOLUME_ABSORPTION":
            return black, scaled(density, each_of("rest", colour))
        return scaled(density, each_of("not negative", colour)), black
    if node.type == "VOLUME_COEFFICIENTS":
        scattering, absorption = (
            scaled(weight, each_of("not negative", reader.value(place, f"{which} Coefficients")))
            for which in ("Scatter", "Absorption")
        )
        return scattering, absorption
    if even:
        reader.notices.append(f"{reader.owner}: its volume shader {node.bl_rna.name} is not shown; it fills nothing")
        return black, black
    reader.notices.append(f"{reader.owner}: its volume shader {node.bl_rna.name} is shown as white smoke of density 1")
    white = scaled(
        math_of("MULTIPLY", weight, fields.grid("density", "Fac", absent=1.0)), fields.constant((1.0, 1.0, 1.0))
    )
    return white, black


def scaled(number: Field, colour: Field) -> Field:
    """Black where one is 0: of what is multiplied by nothing, Cycles asks no grid."""
    if any(field.constant is not None and not field.constant.any() for field in (number, colour)):
        return fields.constant((0.0, 0.0, 0.0))
    return fields.of("scaled", number, colour)


def _density(reader: Reader, place: Place, weight: Field) -> Field:
    return math_of("MULTIPLY", weight, not_negative(reader.value(place, "Density")))


def _anisotropy(reader: Reader, place: Place) -> Field:
    """Of Henyey and Greenstein's phase function; of the others, the mean cosine."""
    phase = getattr(place.node, "phase", "HENYEY_GREENSTEIN")
    found = fields.constant(0.0)
    # Some Blenders find a socket by its name only where the phase function has it.
    if phase in {"HENYEY_GREENSTEIN", "DRAINE"} and "Anisotropy" in place.node.inputs:
        found = reader.value(place, "Anisotropy")
        found = fields.of("clamp", found, fields.constant(-_MOST), fields.constant(_MOST))
    elif phase not in {"HENYEY_GREENSTEIN", "RAYLEIGH"}:
        found = fields.constant(_FORWARD)
    if phase != "HENYEY_GREENSTEIN":
        shown = "its Anisotropy" if found.constant is None else f"an anisotropy of {float(found.constant[0]):.3g}"
        name = place.node.bl_rna.properties["phase"].enum_items[phase].name
        reader.notices.append(f"{reader.owner}: its phase function {name} is shown as Henyey-Greenstein's by {shown}")
    return found


# What is large to light, as droplets and what floats in water, scatters forwards.
_FORWARD = 0.9


def _emitted(reader: Reader, place: Place, weight: Field) -> Iterator[Field]:
    node = place.node
    if not compat.mixes_emission():
        weight = math_of("GREATER_THAN", weight, fields.constant(0.0))
    if node.type == "EMISSION":
        yield from _visible(_glow(reader, place, "Strength", "Color", weight))
    elif node.type == "PRINCIPLED_VOLUME":
        yield from _visible(_glow(reader, place, "Emission Strength", "Emission Color", weight))
        intensity = reader.value(place, "Blackbody Intensity")
        if intensity.constant is None or float(intensity.constant[0]) > 1e-5:
            kelvin = math_of(
                "MULTIPLY", reader.value(place, "Temperature"), _named_grid(place, "Temperature Attribute")
            )
            tint = reader.value(place, "Blackbody Tint")
            yield from _visible(scaled(weight, fields.of("fire", kelvin, intensity, tint)))
    elif node.type == "VOLUME_COEFFICIENTS":
        yield from _visible(scaled(weight, reader.value(place, "Emission Coefficients")))


def _glow(reader: Reader, place: Place, strength: str, colour: str, weight: Field) -> Field:
    power = reader.value(place, strength)
    if power.constant is not None and float(power.constant[0]) <= 0.0:
        return fields.constant((0.0, 0.0, 0.0))
    return scaled(math_of("MULTIPLY", weight, not_negative(power)), reader.value(place, colour))


def _visible(glow: Field) -> Iterator[Field]:
    known: NDArray[np.float64] | None = glow.constant
    if known is None or (known > 0.0).any():
        yield each_of("not negative", glow)
