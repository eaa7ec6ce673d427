# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the pictures of views, and owns every GPU object of the add-on.

A picture is kept until the camera, the size or the frame changes; handing it to Blender is then a copy. While the
view moves it is made at a glance (Frame.glance): few pixels are traced, and those between them where an edge is. A
GPU marches through the smoke up to such surfaces; where the processor would have to do that too, it makes the whole
picture, of which most is interpolated. Targets and uniforms stay while the size does. The surfaces are a new texture
each time, since `gpu` has no way to write to one.
"""

from __future__ import annotations

import time
from collections import OrderedDict
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from .. import core, log
from ..gpu import passes
from ..gpu.drawn import Drawn, view_matrix
from ..gpu.shader import ShaderError, Shaders, texture
from ..gpu.smoke import SHADOW_STRENGTH, Smoke
from . import sorting
from .pace import HALF, Pace

PICTURES_KEPT = 8  # a quad view has four


@dataclass(frozen=True)
class Look:
    """How a frame is looked at. A picture is good until this changes."""

    matrix: tuple[float, ...]  # the frame's space -> NDC, row by row
    size: tuple[int, int]  # pixels
    overlay: bool = False  # over Blender's picture, or by ourselves
    solids_shade: bool = False  # whether that picture shows the shadows of solids; else an overlay adds those too
    sorting: str = sorting.AUTO  # of view/sorting.py
    lens: tuple[tuple[str, Any], ...] = ()  # at rest: of the camera that is looked through, or of none

    @property
    def output(self) -> str:
        """What is asked of Frame.surfaces."""
        if not self.overlay:
            return "radiance"
        return "smoke_shadow" if self.solids_shade else "all_shadows"

    def by_processor(self, frame: Any) -> bool:
        """Whether the whole picture is, unless what is sorted is drawn: a GPU marches through grids alone, and the surfaces
        that it marches up to have no alpha of their own."""
        return self.sorts(frame) or not (self.overlay or frame.opaque)

    def sorts(self, frame: Any) -> bool:
        """Whether anything else than grids lies before surfaces. Transparent meshes and hair are in Blender's own picture."""
        return bool(frame.particles or frame.air if self.overlay else frame.sorted)

    def moves_to(self, other: Look) -> bool:
        """Whether only the camera is another, or its lens."""
        return self != other and replace(self, matrix=other.matrix, lens=other.lens) == other

    def camera(self) -> Any:
        return core.module().Camera(np.reshape(self.matrix, (4, 4)))

    def exposure(self) -> Any:
        """The camera with its lens."""
        return core.module().Exposure([self.camera()], **dict(self.lens))


@dataclass(frozen=True)
class Picture:
    """What a view shows: radiance, and in an overlay the transmittance for what lies behind."""

    frame: Any
    look: Look
    refined: bool  # made of surfaces that are sampled as F12's
    radiance: Any
    transmittance: Any | None
    buffer: Any | None  # of these two, where the GPU has drawn them

    def moves_to(self, frame: Any, look: Look) -> bool:
        """Whether what is to be shown now is a part of a movement: another place of the camera; or, before the view has
        come to rest, another frame, as when a sun is dragged or a simulation is played."""
        if self.frame is frame:
            return self.look.moves_to(look)
        return not self.refined and (self.look == look or self.look.moves_to(look))


@dataclass
class _View:
    """What is kept of one view."""

    picture: Picture | None = None
    target: passes.Target | None = None
    pace: Pace = field(default_factory=Pace)

    def target_for(self, look: Look) -> passes.Target:
        if self.target is None or (self.target.size, self.target.overlay) != (look.size, look.overlay):
            self.picture = self.target = None  # free first
            self.target = passes.Target(look.size, look.overlay)
        return self.target


class Painter:
    """Dropping it frees what it owns."""

    def __init__(self) -> None:
        self.software = passes.is_software()
        self._shaders = Shaders()
        self._smoke: dict[bool, Smoke] = {}  # the overlay's, and the Rendered view's: their frames differ
        self._views: OrderedDict[Any, _View] = OrderedDict()
        self._drawn = Drawn()
        self.sorted_by = ""  # what is seen through, in the last picture that had any

    def picture(self, view: Any, frame: Any, look: Look, refined: Any = None) -> Picture:
        """The smoke of `frame`. `view` is any name: the picture is kept under it until something else is asked of it,
        or there are `refined` surfaces to make it of."""
        kept = self._views.pop(view, None) or _View()
        self._views[view] = kept
        while len(self._views) > PICTURES_KEPT:
            self._views.popitem(last=False)
        known = kept.picture
        if refined is not None or known is None or known.look != look or known.frame is not frame:
            moves = known is not None and known.moves_to(frame, look)
            spacing = kept.pace.moved(time.monotonic()) if moves and refined is None else 1
            kept.picture = self._make_picture(kept, frame, look, refined, spacing)
        assert kept.picture is not None
        return kept.picture

    def _make_picture(self, view: _View, frame: Any, look: Look, refined: Any, spacing: int) -> Picture:
        """With a spacing above 1, at a glance."""
        if not look.sorts(frame):
            self.sorted_by = ""
        if refined is None and look.sorts(frame):
            drawn = self._drawn_picture(view, frame, look, spacing)
            if drawn is not None:
                return drawn
        if look.by_processor(frame) or (look.lens and refined is not None):
            # What is sorted is not for every pixel at once: they follow, refined.
            return _processed(frame, look, max(spacing, HALF) if look.sorts(frame) else spacing, refined)
        if spacing > 1 and self.software:
            return _processed(frame, look, spacing)
        traced = _surfaces(frame, look, look.output, spacing) if refined is None else refined
        target = self._marched(view, frame, look, texture(look.size, "RGBA", traced))
        return _of_target(frame, look, target, refined is not None)

    def _drawn_picture(self, view: _View, frame: Any, look: Look, spacing: int) -> Picture | None:
        """With all that is seen through drawn by the GPU before surfaces of the processor's; None where that is not the
        way."""
        way = sorting.way_of(look.sorting, frame, self.software)
        self.sorted_by = way.why
        if not way.method:
            return None
        camera, matrix = look.camera(), np.reshape(look.matrix, (4, 4))
        fragments = self._drawn.fragments(frame, camera, look.size, look.overlay, way.method)
        way = sorting.way_for(way, look.sorting, len(fragments), fragments.has_triangles)
        surfaces = texture(
            look.size, "RGBA", _surfaces(frame, look, look.output if look.overlay else "opaque", spacing)
        )
        axis = -view_matrix(matrix)[2]
        try:
            solids = passes.distances(self._shaders, surfaces, camera.corners, axis)
            picture = self._drawn.composite(frame, fragments, matrix, look.size, way.method, solids)
            target = self._marched(view, frame, look, surfaces)
            target.lay_over(self._shaders, picture)
        except ShaderError as error:
            self.sorted_by = "the processor: a shader did not compile"
            log.replace("sorting", [f"What is seen through is sorted by the processor, not drawn: {error}"])
            return None
        log.replace("sorting", [])
        self.sorted_by = way.why
        return _of_target(frame, look, target, False)

    def _marched(self, view: _View, frame: Any, look: Look, surfaces: Any) -> passes.Target:
        """The smoke of grids up to surfaces, and these."""
        smoke = self._smoke.get(look.overlay)
        if smoke is None or smoke.frame is not frame:
            self._smoke.pop(look.overlay, None)  # free first: two large volumes may not fit
            smoke = self._smoke[look.overlay] = Smoke(frame)
        target = view.target_for(look)
        passes.draw_smoke(self._shaders, target, smoke, surfaces, look.camera().corners)
        return target

    def composite(
        self, picture: Any, blend: str, gain: float, least_alpha: float, window: tuple[int, int, int, int] | None = None
    ) -> None:
        """Draw a texture of the target's size over what the bound target holds, or over a window of it: left, bottom,
        width, height in pixels."""
        passes.composite(self._shaders, picture, blend, gain, least_alpha, window)

    def dim_background(self, picture: Picture, gain: float, background: tuple[float, float, float]) -> None:
        """Multiply the bound target, that of Blender's overlays, by what the smoke leaves of the background."""
        passes.dim_background(self._shaders, picture.radiance, picture.transmittance, gain, background)


def _surfaces(frame: Any, look: Look, output: str, spacing: int) -> Any:
    """For the GPU, at a glance with a spacing above 1."""
    if spacing > 1:
        return frame.glance(look.camera(), *look.size, output, spacing)
    return frame.surfaces(look.camera(), *look.size, output=output)


def _of_target(frame: Any, look: Look, target: passes.Target, refined: bool) -> Picture:
    transmittance = target.textures[1] if look.overlay else None
    return Picture(frame, look, refined, target.textures[0], transmittance, target.buffer)


def _processed(frame: Any, look: Look, spacing: int, refined: Any = None) -> Picture:
    """A picture made by the processor alone, at a glance unless there is a refined one."""
    traced = glance(frame, look, spacing) if refined is None else refined
    radiance, *rest = (texture(look.size, "RGBA", plane) for plane in (traced if look.overlay else (traced,)))
    return Picture(frame, look, refined is not None, radiance, rest[0] if rest else None, None)


def glance(frame: Any, look: Look, spacing: int) -> Any:
    """The whole picture, and of an overlay two: the transmittance, too."""
    if look.overlay:
        return frame.glance(look.camera(), *look.size, look.output, spacing, SHADOW_STRENGTH)
    return frame.glance(look.camera(), *look.size, spacing=spacing)


_painter: Painter | None = None


def painter() -> Painter:
    global _painter
    if _painter is None:
        _painter = Painter()
    return _painter


def sorted_by() -> str:
    """How what is seen through was put in order in the last picture that had any."""
    return "" if _painter is None else _painter.sorted_by


def free() -> None:
    """Free every GPU object. What is drawn next makes its own again."""
    global _painter
    _painter = None
