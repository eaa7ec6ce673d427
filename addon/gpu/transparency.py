# SPDX-License-Identifier: GPL-3.0-or-later
"""Transparent fragments on the GPU: soft sprites and triangles in one batch, composited without sorting.

The methods are those of shaders/frame/oit.glsl. Blender 3.4 has neither image atomics nor blending by minimum, so the
nearest layers are peeled, by a depth test each. What adds up does so in single floats, and what is kept is rounded once:
half floats that are added to stall. `half` asks for them all the same, as Song published his method.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import arguments
from .fragments import LIT, SOLIDS, Fragments, declare_fragments
from .shader import Shaders, compile_shader, plain_state

NEAREST = 4  # layers
MOST_TERMS = 12  # of the published series, two a colour target
NO_DEPTH = 2.0  # behind all depths
METHODS = ("nearest", "fourier", "weighted", "sorted")

TEXT = ["camera.glsl", "rays/opacity.glsl", "rays/basis.glsl", "frame/oit.glsl", "media/puff.glsl"]
VERTEX = ["rays/opacity.glsl", "viewport/fragment_vertex.glsl"]


@dataclass(frozen=True)
class View:
    """What fragments are seen through. from_world and projection (4, 4): Blender's; size (width, height); solids, a
    texture of that size whose red is the distance along the view, in metres, of what is opaque there."""

    from_world: ArrayLike
    projection: ArrayLike
    size: tuple[int, int]
    solids: Any = None


@dataclass(frozen=True)
class Light:
    """A light map that shades sprites (LightMaps.splat), with its coefficients and its world_to_map (4, 4)."""

    light_map: Any
    coefficients: int
    world_to_map: ArrayLike


class Transparency:
    """Composites fragments. Owns its shaders; pictures are given away."""

    def __init__(self) -> None:
        self._shaders = Shaders()

    def composite(
        self,
        fragments: Fragments,
        view: View,
        method: str = "nearest",
        light: Light | None = None,
        terms: int = 4,
        sigma: float = 1.0,
        half: bool = False,
    ) -> Any:
        """The picture: a GPUTexture, premultiplied radiance and opacity, in half floats.

        method: `nearest`, ours; `fourier`, of `terms` terms, with sigma factors to the power `sigma`; `weighted`; or
        `sorted`, sprites alone, drawn back to front by their middles, as Jansen and Bavoil drew theirs. `half`: the sums
        of `fourier` are half floats, as published. With a light its map shades sprites. Raises ValueError for anything
        unusable.
        """
        if method not in METHODS:
            raise ValueError(f"method is '{method}', but must be one of {', '.join(map(repr, METHODS))}")
        if method == "sorted" and fragments.has_triangles:
            raise ValueError("method is 'sorted', but fragments has triangles, which may intersect")
        arguments.within(terms, 2, MOST_TERMS, "terms")
        drawing = _Drawing(self._shaders, fragments, view, light)
        ways: dict[str, Callable[[], Any]] = {
            "nearest": drawing.nearest,
            "fourier": lambda: drawing.fourier(terms, sigma, "RGBA16F" if half else "RGBA32F"),
            "weighted": drawing.weighted,
            "sorted": drawing.back_to_front,
        }
        return ways[method]()


class _Drawing:
    """One picture, pass by pass."""

    def __init__(self, shaders: Shaders, fragments: Fragments, view: View, light: Light | None) -> None:
        self.shaders, self.fragments, self.view, self.light = shaders, fragments, view, light
        self.uniforms = fragments.uniforms(view.from_world, view.projection, light.world_to_map if light else np.eye(4))

    def nearest(self) -> Any:
        import gpu

        size = self.view.size
        depth = gpu.types.GPUTexture(size, format="DEPTH_COMPONENT32F")
        depths: dict[str, Any] = {}
        previous = self._picture("R32F")
        previous.clear(format="FLOAT", value=(-1.0,))  # before all depths
        for name in (*(f"layer{layer}" for layer in range(NEAREST)), "nearest"):
            previous = depths[name] = self._peel(depth, previous, nearest=True)
        depths["furthest"] = self._peel(depth, depths[f"layer{NEAREST - 1}"], nearest=False)

        sums = {"layers": self._picture("RGBA32F"), "tail": self._picture("RGBA32F")}
        self._add("gather", ["viewport/gather_fragment.glsl"], depths, sums)
        # One channel each: of integers, Blender 3.4 writes no more than that.
        kept = {f"kept{layer}": self._picture("R32UI") for layer in range(NEAREST)}
        kept |= {"series": self._picture("R32UI"), "total": self._picture("R16UI")}
        self._screen("keep", ["viewport/keep_fragment.glsl"], depths | sums, kept)
        del depth, previous, depths
        colours = {"of_layers": sums["layers"], "of_tail": sums["tail"]}  # whose sums have done their work
        self._add("nearest", ["viewport/kept.glsl", "viewport/nearest_fragment.glsl"], kept, colours)
        return self._finish("nearest", ["viewport/kept.glsl", "viewport/nearest_finish_fragment.glsl"], kept | colours)

    def fourier(self, terms: int, sigma: float, form: str) -> Any:
        layers = {f"layer{layer}": self._picture(form) for layer in range((terms + 1) // 2)}

        def of_series(info: Any) -> None:
            info.define("FIRST", "0")
            info.define("HARMONICS", str(terms - 1))
            each = (f"f({number}, {name}, unused)" for number, name in enumerate(layers))
            info.define("EACH_LAYER(f)", " ".join(each))

        def of_exponent(info: Any) -> None:
            of_series(info)
            info.push_constant("FLOAT", "sigma")

        gather = ["viewport/light_map_layers.glsl", "viewport/fourier_gather_fragment.glsl"]
        self._add(f"fourier gather, {terms} terms", gather, {}, layers, of_series)
        sums = {"sums": self._picture(form)}
        self._add(
            f"fourier, {terms} terms", ["viewport/fourier_fragment.glsl"], layers, sums, of_exponent, {"sigma": sigma}
        )
        return self._finish("fourier", ["viewport/fourier_finish_fragment.glsl"], sums | {"layer0": layers["layer0"]})

    def weighted(self) -> Any:
        sums = {"sums": self._picture("RGBA32F"), "total": self._picture("R32F")}
        self._add("weighted", ["viewport/weighted_fragment.glsl"], {}, sums)
        return self._finish("weighted", ["viewport/weighted_finish_fragment.glsl"], sums)

    def back_to_front(self) -> Any:
        picture = self._picture("RGBA32F")
        files = ["viewport/over_fragment.glsl"]
        order = self.fragments.back_to_front(self.view.from_world)
        with self._fragments("over", files, {}, {"picture": picture}) as shader:
            import gpu

            gpu.state.active_framebuffer_get().clear(color=(0.0, 0.0, 0.0, 0.0))
            gpu.state.blend_set("ALPHA_PREMULT")
            self.fragments.draw(shader, order)
        return picture

    def _picture(self, form: str) -> Any:
        import gpu

        return gpu.types.GPUTexture(self.view.size, format=form)

    def _peel(self, depth: Any, previous: Any, nearest: bool) -> Any:
        """The depth of the fragment behind `previous` that is nearest, or furthest, of all; NO_DEPTH where none is."""
        import gpu

        made = self._picture("R32F")
        with self._fragments(
            "peel", ["viewport/peel_fragment.glsl"], {"previous": previous}, {"depth": made}, depth
        ) as shader:
            gpu.state.depth_mask_set(True)  # else the depths are not cleared
            gpu.state.active_framebuffer_get().clear(color=(NO_DEPTH,) * 4, depth=1.0 if nearest else 0.0)
            gpu.state.depth_test_set("LESS" if nearest else "GREATER")
            self.fragments.draw(shader)
        return made

    def _add(
        self,
        name: str,
        files: list[str],
        read: dict[str, Any],
        written: dict[str, Any],
        declare: Callable[[Any], None] | None = None,
        numbers: dict[str, float] | None = None,
    ) -> None:
        """Draw all fragments into targets that add up."""
        import gpu

        with self._fragments(name, files, read, written, None, declare) as shader:
            gpu.state.active_framebuffer_get().clear(color=(0.0, 0.0, 0.0, 0.0))
            gpu.state.blend_set("ADDITIVE_PREMULT")  # adds all four; ADDITIVE weighs three of them by the fourth
            for number, value in (numbers or {}).items():
                shader.uniform_float(number, value)
            self.fragments.draw(shader)

    @contextmanager
    def _fragments(
        self,
        name: str,
        files: list[str],
        read: dict[str, Any],
        written: dict[str, Any],
        depth: Any = None,
        declare: Callable[[Any], None] | None = None,
    ) -> Iterator[Any]:
        """A shader of fragments, its targets and its textures, bound."""
        import gpu

        variants, coefficients, textures = [], 0, dict(read)
        if self.light is not None:
            variants.append(LIT)
            coefficients = self.light.coefficients
            textures["light_map"] = self.light.light_map
        if self.view.solids is not None:
            variants.append(SOLIDS)
            textures["solids"] = self.view.solids

        def declare_all(info: Any) -> None:
            info.define("NO_DEPTH", f"{NO_DEPTH}f")
            declare_fragments(info, variants, coefficients, self.fragments.slices)
            _declare_textures(info, textures, written)
            if declare is not None:
                declare(info)

        text = [*TEXT, "viewport/light_map_look_up.glsl"] if self.light is not None else TEXT
        key = (name, *variants, coefficients, self.fragments.slices)
        shader = self.shaders.get(
            key,
            lambda: compile_shader(name, declare_all, [*text, "viewport/fragment.glsl", *files], VERTEX),
        )
        buffer = gpu.types.GPUFrameBuffer(color_slots=list(written.values()), depth_slot=depth)
        with plain_state(), buffer.bind():
            shader.bind()
            shader.uniform_block("view", self.uniforms)
            for texture, held in textures.items():
                shader.uniform_sampler(texture, held)
            yield shader

    def _screen(self, name: str, files: list[str], read: dict[str, Any], written: dict[str, Any]) -> None:
        """A pass over the pixels."""
        import gpu

        def declare(info: Any) -> None:
            info.define("NO_DEPTH", f"{NO_DEPTH}f")
            _declare_textures(info, read, written)

        shader = self.shaders.get(
            name,
            lambda: compile_shader(name, declare, [*TEXT, *files]),
        )
        with plain_state(), gpu.types.GPUFrameBuffer(color_slots=list(written.values())).bind():
            shader.bind()
            for texture, held in read.items():
                shader.uniform_sampler(texture, held)
            self.shaders.draw_screen(shader)

    def _finish(self, name: str, files: list[str], read: dict[str, Any]) -> Any:
        picture = self._picture("RGBA16F")
        self._screen(f"{name} finish", files, read, {"picture": picture})
        return picture


def _is_integer(texture: Any) -> bool:
    return bool(texture.format.endswith("UI"))


def _declare_textures(info: Any, read: dict[str, Any], written: dict[str, Any]) -> None:
    for slot, (name, texture) in enumerate(read.items()):
        kind = "UINT_2D" if _is_integer(texture) else "FLOAT_2D"
        info.sampler(slot, "FLOAT_2D_ARRAY" if name == "light_map" else kind, name)
    for slot, (name, texture) in enumerate(written.items()):
        info.fragment_out(slot, "UINT" if _is_integer(texture) else "VEC4", name)
