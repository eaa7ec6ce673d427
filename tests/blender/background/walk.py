# SPDX-License-Identifier: GPL-3.0-or-later
"""A walk through what Cycles reads of a scene, by Blender's own lists of properties: each is followed, named or without
effect, as the tables of addon/export/known have it; and what is named is said. What a new Blender adds fails here. Nodes:
walk_nodes.py; whether what is followed is: followed.py."""

from collections.abc import Callable, Iterator
from typing import Any

import bpy
import harness
from sfumato.export.known import Named, Struct, objects
from stage import TABLES, Stage, names_in


def listed(table: Struct) -> list[str]:
    return [*names_in(table.followed), *{named.property for named in table.named}, *names_in(table.idle)]


def structs() -> Iterator[bpy.types.Struct]:
    """Those of the tables that are in this Blender, and all of Cycles' settings but those of its preferences."""
    found = {}
    for name in dir(bpy.types):
        rna = getattr(getattr(bpy.types, name), "bl_rna", None)
        if rna is None:
            continue
        found[name] = rna
        for prop in rna.properties:
            if prop.type == "POINTER" and prop.fixed_type.identifier.startswith("Cycles"):
                found[prop.fixed_type.identifier] = prop.fixed_type
    for name, rna in found.items():
        cycles = name.startswith("Cycles") and name.endswith("Settings") and "View3DShading" not in name
        if name in TABLES or cycles:
            yield rna


def own_properties(rna: Any) -> set[str]:
    """What a struct adds to that on which it is based."""
    base = {prop.identifier for prop in rna.base.properties} if rna.base is not None else set()
    inherited = {"rna_type", "animation_data", "sfumato"} | (
        {"name"} if rna.identifier not in {"LayerCollection"} else set()
    )
    elsewhere = {
        prop.identifier
        for prop in rna.properties
        if prop.type == "POINTER" and prop.fixed_type.identifier in {*TABLES} - {"Object", "World"}
    }
    return {prop.identifier for prop in rna.properties} - base - inherited - elsewhere


def test_every_property_is_in_a_table_once() -> None:
    wrong = []
    seen = set()
    for rna in structs():
        name = rna.identifier
        seen.add(name)
        if name not in TABLES:
            wrong.append(f"{name} is in no table")
            continue
        known = listed(TABLES[name])
        wrong += [f"{name}.{prop} is in no table" for prop in sorted(own_properties(rna) - set(known))]
        wrong += [f"{name}.{prop} is there twice" for prop in sorted(set(known)) if known.count(prop) > 1]
    assert {"Object", "Scene", "CyclesRenderSettings", "CyclesObjectSettings"} <= seen
    assert not wrong, "\n".join(wrong)


def other_value(prop: Any, neutral: tuple[Any, ...]) -> Any:
    """What a property can be set to that none of `neutral` is."""
    if prop.type == "BOOLEAN":
        return not neutral[0]
    if prop.type == "ENUM":
        return next(item.identifier for item in prop.enum_items if item.identifier not in neutral)
    if prop.type == "POINTER":
        made = {"Material": bpy.data.materials, "World": bpy.data.worlds, "Collection": bpy.data.collections}
        return made[prop.fixed_type.identifier].new("Other")
    return neutral[0] - 0.5 if neutral[0] + 0.5 > prop.hard_max else neutral[0] + 0.5


def as_said(value: Any, prop: Any) -> str:
    if prop.type == "ENUM":
        return str(prop.enum_items[value].name)
    return value.name if isinstance(value, bpy.types.ID) else f"{value:.3g}"


def adaptive(stage: Stage) -> str:
    modifier = stage.floor.modifiers.new("Finer", "SUBSURF")
    if hasattr(modifier, "use_adaptive_subdivision"):
        modifier.use_adaptive_subdivision = True
    else:
        stage.scene.cycles.feature_set = "EXPERIMENTAL"
        stage.floor.cycles.use_adaptive_subdivision = True
    return "Floor"


def catching(stage: Stage) -> str:
    stage.smoke.is_shadow_catcher = True
    return "Smoke"


def clipped(stage: Stage) -> str:
    stage.smoke.data.render.clipping = 0.2
    return "Smoke"


def without_transparent_shadow(stage: Stage) -> str:
    stage.floor_shader.inputs["Alpha"].default_value = 0.5
    material = stage.floor.data.materials[0]
    (material if hasattr(material, "use_transparent_shadow") else material.cycles).use_transparent_shadow = False
    return "Floor"


def _of_glass(stage: Stage) -> None:
    """Of which nothing else is said."""
    stage.floor.data.materials.clear()
    harness.put(harness.shade(stage.floor.data, "ShaderNodeBsdfRefraction"), IOR=1.0, Roughness=0.0)
    stage.scene.cycles.blur_glossy = 0.0
    stage.lamp.data.shadow_soft_size = 0.1


def without_caustics(stage: Stage) -> str:
    _of_glass(stage)
    stage.scene.cycles.caustics_refractive = False
    return "Floor"


def with_filter_glossy(stage: Stage) -> str:
    _of_glass(stage)
    stage.scene.cycles.blur_glossy = 0.5
    return "Floor"


def before_a_transparent_film(stage: Stage) -> str:
    _of_glass(stage)
    stage.scene.render.film_transparent = True
    stage.scene.cycles.film_transparent_glass = False
    return "Floor"


# What takes more than one property to be said, and how it comes about.
TOGETHER: dict[tuple[str, str], Callable[[Stage], str]] = {
    ("Object", "is_shadow_catcher"): catching,
    ("CyclesObjectSettings", "use_adaptive_subdivision"): adaptive,
    ("VolumeRender", "clipping"): clipped,
    ("Material", "use_transparent_shadow"): without_transparent_shadow,
    ("CyclesMaterialSettings", "use_transparent_shadow"): without_transparent_shadow,
    ("CyclesRenderSettings", "caustics_refractive"): without_caustics,
    ("CyclesRenderSettings", "blur_glossy"): with_filter_glossy,
    ("CyclesRenderSettings", "film_transparent_glass"): before_a_transparent_film,
}


def value_at(owner: Any, path: str) -> tuple[Any, str] | None:
    """The struct at a path, and the last name of it; None where this Blender has no such."""
    *way, last = path.split(".")
    for part in way:
        owner = getattr(owner, part, None)
    return (owner, last) if hasattr(owner, last) else None


def test_what_is_named_is_said_once_with_its_owner_and_value() -> None:
    stage = Stage()
    before = set(stage.said())
    wrong: list[str] = []
    tried = 0
    for table in TABLES.values():
        for named in table.named:
            if (table.name, named.property) in TOGETHER:
                continue
            path = table.path(named)
            for owner, name in stage.owners(table.root, named.kinds):
                found = value_at(owner, path)
                if found is None:
                    continue
                tried += 1
                wrong += said_of(stage, before, named, owner, name, *found)
    assert tried >= 38, tried
    assert not wrong, "\n".join(wrong)


def said_of(
    stage: Stage, before: set[str], named: Named, owner: Any, name: str, struct: Any, last: str
) -> Iterator[str]:
    """What is wrong with what is said once a property is set; it is set back."""
    prop = struct.bl_rna.properties[last]
    for other, needed in named.when:
        place, end = value_at(owner, other) or (None, "")
        setattr(place, end, needed)
    if prop.type == "COLLECTION":
        getattr(struct, last).add()
        value: Any = 1
    else:
        value = other_value(prop, named.neutral)
        kept = getattr(struct, last)
        setattr(struct, last, value)
    new = [line for line in stage.said() if line not in before]
    right = len(new) == 1 and new[0].startswith(f"{name}: ")
    if not right or ("{value}" in named.says and as_said(value, prop) not in new[0]):
        yield f"{name}.{last} = {value!r}: {new}"
    if prop.type == "COLLECTION":
        remove_first(struct, last)
    else:
        setattr(struct, last, kept)
    for other, needed in named.when:
        if isinstance(needed, bool):
            place, end = value_at(owner, other) or (None, "")
            setattr(place, end, not needed)


def remove_first(layer: Any, name: str) -> None:
    operators = {"aovs": bpy.ops.scene.view_layer_remove_aov, "lightgroups": bpy.ops.scene.view_layer_remove_lightgroup}
    operators[name]()


def test_what_takes_more_than_a_property_is_said_once_too() -> None:
    every = {(table.name, named.property) for table in TABLES.values() for named in table.named if named.elsewhere}
    assert every >= set(TOGETHER), set(TOGETHER) - every
    wrong = []
    for key, setting in TOGETHER.items():
        if "linking" in key[1] + key[0].lower() and not hasattr(bpy.types, "ObjectLightLinking"):
            continue
        stage = Stage()
        before = stage.said()
        name = setting(stage)
        new = [line for line in stage.said() if line not in before]
        if len(new) != 1 or not new[0].startswith(f"{name}: "):
            wrong.append(f"{key}: {new}")
    assert not wrong, "\n".join(wrong)


def test_types_of_objects_that_are_not_shown_are_named() -> None:
    made: dict[str, Callable[[], Any]] = {
        "GPENCIL": lambda: bpy.data.grease_pencils.new("Thing"),
        "GREASEPENCIL": lambda: getattr(bpy.data, "grease_pencils_v3", bpy.data.grease_pencils).new("Thing"),
    }
    assert set(made) == set(objects.UNSHOWN)
    there = set(bpy.types.Object.bl_rna.properties["type"].enum_items.keys())
    if "GREASEPENCIL" in there:  # 4.3: the older type is still listed for a while
        there.discard("GPENCIL")
    wrong: list[str] = []
    for kind in sorted(set(made) & set(there)):
        stage = Stage()
        before = stage.exported()
        stage.add("Thing", made[kind]())
        wrong.append(stage.not_heard_once(before, "Thing: ", objects.UNSHOWN[kind]))
    assert wrong and not any(wrong), "\n".join(wrong)


harness.main()
