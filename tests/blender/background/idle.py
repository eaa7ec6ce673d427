# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tables of addon/export/known say makes no difference: with all of it set to something else, the Cycles of this
very Blender gives the same picture, bit for bit. What does change Cycles' picture, but not ours, is left out by its reason.
"""

from typing import Any

import harness
import numpy as np
import pictures
from numpy.typing import NDArray
from sfumato.export.known import Struct
from stage import TABLES, Stage

# Noise and how Cycles deals with it, light that is passed on; and what would change the file or break the test.
SEEN_IN_CYCLES = ("noise", "pass on", "light of the world", "marches smoke", "denoisers", "guided paths", "artefacts",
                  "speed", "rounds", "Freestyle", "writes", "interface")  # fmt: skip
LAMPS = {"SpotLight": "SPOT", "SunLight": "SUN", "AreaLight": "AREA"}


def idle(table: Struct) -> list[str]:
    reasons = (reason for reason in table.idle if not any(word in reason for word in SEEN_IN_CYCLES))
    return [name for reason in reasons for name in table.idle[reason].split()]


def other_value(struct: Any, name: str) -> Any:
    """What else a property can be, or None."""
    prop = struct.bl_rna.properties[name]
    if prop.is_readonly or prop.type not in {"BOOLEAN", "ENUM", "INT", "FLOAT"}:
        return None
    value = getattr(struct, name)
    if prop.type == "ENUM":
        others = [item.identifier for item in prop.enum_items if item.identifier != value]
        return others[0] if others and not prop.is_enum_flag else None
    if prop.type == "BOOLEAN":
        return None if prop.is_array else not value
    if prop.is_array:
        return None
    moved = 0.5 * value + 1.0 if value < 1.0 else 0.5 * value
    return type(value)(min(max(moved, prop.hard_min), prop.hard_max))


def owners_of(stage: Stage, table: Struct) -> list[Any]:
    """The structs on the stage that a table is of."""
    materials = [thing.data.materials[0] for thing in (stage.floor, stage.glow, stage.smoke)]
    several = {"object": [stage.floor, stage.glow, stage.smoke, stage.lamp], "material": materials, "mesh": []}
    found = several.get(table.root) or [owner for owner, _ in stage.owners(table.root, ())]
    for part in table.at.split(".") if table.at else ():
        found = [getattr(owner, part) for owner in found if hasattr(owner, part)]
    return found


def change(structs: list[Any], names: list[str]) -> list[tuple[Any, str, Any]]:
    """Set what can be set, and give back what was there."""
    kept = []
    for struct in structs:
        for name in names:
            value = other_value(struct, name) if hasattr(struct, name) else None
            if value is not None:
                kept.append((struct, name, getattr(struct, name)))
                try:
                    setattr(struct, name, value)
                except (AttributeError, TypeError):  # of another kind of object, or not among this one's choices
                    kept.pop()
    return kept


def by_cycles(stage: Stage) -> NDArray[np.float32]:
    cycles = stage.scene.cycles
    cycles.samples, cycles.seed = 2, 1
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    if hasattr(cycles, "volume_biased"):
        cycles.volume_biased = True  # ten times as fast
    return pictures.render(None, "CYCLES")


def test_cycles_does_not_see_what_makes_no_difference() -> None:
    wrong: list[str] = []
    changed = 0
    for lamp in ("POINT", *LAMPS.values()):
        stage = Stage(lamp)
        plain = by_cycles(stage)
        assert np.array_equal(plain, by_cycles(stage)), "Cycles repeats itself"
        for table in TABLES.values():
            if LAMPS.get(table.name, "POINT") != lamp or table.root == "mesh":
                continue
            structs = owners_of(stage, table)
            kept = change(structs, idle(table))
            changed += len(kept)
            if not np.array_equal(plain, by_cycles(stage)):
                wrong.append(table.name)
            for struct, name, value in reversed(kept):
                setattr(struct, name, value)
    assert changed > 200, changed
    assert not wrong, wrong


def test_what_is_left_out_is_in_the_tables() -> None:
    reasons = {reason for table in TABLES.values() for reason in table.idle}
    assert all(any(word in reason for reason in reasons) for word in SEEN_IN_CYCLES)


harness.main()
