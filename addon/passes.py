# SPDX-License-Identifier: GPL-3.0-or-later
"""What a view layer asks for beside its picture: Blender's passes as Cycles has them, and our own for compositors."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from . import compat

Images = dict[str, NDArray[np.float32]]

FARTHEST = 1e10  # the depth where there is nothing, as in Cycles


@dataclass(frozen=True)
class Pass:
    """A pass of a render result, and the image of Frame.passes that it is made of."""

    name: str
    channels: str
    kind: str  # what nodes take it for
    switch: str  # of the view layer, or of our settings there
    image: str

    @property
    def own(self) -> bool:
        return not self.switch.startswith("use_")


PASSES = (
    Pass("Depth", "Z", "VALUE", "use_pass_z", "position"),
    Pass("Mist", "Z", "VALUE", "use_pass_mist", "mist"),
    Pass("Position", "XYZ", "VECTOR", "use_pass_position", "position"),
    Pass("Normal", "XYZ", "VECTOR", "use_pass_normal", "normal"),
    Pass(compat.index_pass("Object"), "X", "VALUE", "use_pass_object_index", "object_index"),
    Pass(compat.index_pass("Material"), "X", "VALUE", "use_pass_material_index", "material_index"),
    Pass("Smoke", "RGBA", "COLOR", "smoke", "smoke"),
    Pass("Smoke Shadow", "RGB", "COLOR", "smoke_shadow", "smoke_shadow"),
    Pass("Shadow", "RGB", "COLOR", "use_pass_shadow", "shadow"),
)


class SfumatoViewLayerSettings(bpy.types.PropertyGroup):
    smoke: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="Smoke",
        description="The smoke alone, premultiplied, to be laid over another picture: what it sends to the camera, and "
        "how much it hides",
    )
    smoke_shadow: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="Smoke Shadow",
        description="The share of their light that the smoke leaves surfaces, to multiply another picture with",
    )


def of(view_layer: Any) -> SfumatoViewLayerSettings:
    """Our settings of a view layer."""
    settings: SfumatoViewLayerSettings = view_layer.sfumato
    return settings


def asked_for(view_layer: Any) -> list[Pass]:
    """The passes that a view layer asks for, of those that we have."""
    return [each for each in PASSES if getattr(of(view_layer) if each.own else view_layer, each.switch)]


def unknown(view_layer: Any) -> list[str]:
    """What else it asks for, by the names that the artist reads."""
    ours = {each.switch for each in PASSES} | {"use_pass_combined", "use_pass_cryptomatte_accurate"}
    found = []
    for owner in (view_layer, getattr(view_layer, "cycles", None)):
        for prop in owner.bl_rna.properties if owner is not None else ():
            name = prop.identifier
            is_pass = name.startswith(("use_pass_", "pass_", "denoising_store_"))
            if is_pass and prop.type == "BOOLEAN" and name not in ours and getattr(owner, name):
                found.append(prop.name)
    found += [f"the AOV '{aov.name}'" for aov in view_layer.aovs]
    found += [f"the light group '{group.name}'" for group in getattr(view_layer, "lightgroups", ())]
    return found


def notices(view_layer: Any) -> list[str]:
    """What is asked for and not made, in one line."""
    missing = unknown(view_layer)
    if not missing:
        return []
    return [
        f"View layer '{view_layer.name}': these passes are not made, and stay out of the file: {', '.join(missing)}"
    ]


def register_passes(engine: Any, scene: Any, view_layer: Any) -> None:
    """For the compositor's Render Layers node."""
    engine.register_pass(scene, view_layer, "Combined", 4, "RGBA", "COLOR")
    for each in asked_for(view_layer):
        engine.register_pass(scene, view_layer, each.name, len(each.channels), each.channels, each.kind)


def mist_of(world: Any) -> tuple[float, float, float]:
    """Start and depth in metres, and the power of the share between them."""
    if world is None:
        return 0.0, 1.0, 1.0
    settings = world.mist_settings
    power = {"QUADRATIC": 2.0, "LINEAR": 1.0, "INVERSE_QUADRATIC": 0.5}[settings.falloff]
    return max(settings.start, 0.0), max(settings.depth, 1e-4), power


def eye_of(camera: Any, view: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
    """From where mist is measured, and along what; `view` takes the frame's space to the camera."""
    to_world = np.linalg.inv(view)
    parallel = camera.data.type == "ORTHO"
    return {"eye": to_world[:3, 3], "axis": -to_world[:3, 2] if parallel else np.zeros(3)}


def pixels_of(wanted: list[Pass], images: Images, view: NDArray[np.float64], origin: NDArray[np.float64]) -> Images:
    """The pixels (height, width, channels) of each pass by name; `view` takes the frame's space, which begins at
    `origin` in the world, to the camera."""
    out = {"Combined": images["picture"]}
    for each in wanted:
        image = images[each.image]
        if each.name == "Depth":
            depth = -(image[..., :3] @ view[2, :3] + view[2, 3])
            image = np.where(image[..., 3] > 0.0, depth, FARTHEST)[..., None]
        elif each.name == "Position":
            image = image[..., :3] + image[..., 3:] * origin.astype(np.float32)
        out[each.name] = image[..., : len(each.channels)]
    return out


def register() -> None:
    bpy.utils.register_class(SfumatoViewLayerSettings)
    bpy.types.ViewLayer.sfumato = bpy.props.PointerProperty(type=SfumatoViewLayerSettings)


def unregister() -> None:
    del bpy.types.ViewLayer.sfumato
    bpy.utils.unregister_class(SfumatoViewLayerSettings)
