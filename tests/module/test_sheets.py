# SPDX-License-Identifier: GPL-3.0-or-later
"""Transparent meshes: what geometry, products of shares and Beer and Lambert's law fix of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from sfumato import Camera, Frame, Mesh, Reach, Scene, Visibility

QUAD = Mesh([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], [[0, 1, 2], [0, 2, 3]])
BLACK = [[0.0, 0.0, 0.0]]
SIZE = 16, 16


def camera(half: float = 0.8, height: float = 10.0) -> Camera:
    """From a height straight down, orthographic, to as far below."""
    return Camera(np.diag([1.0 / half, 1.0 / half, -1.0 / height, 1.0]))


def place(z: float, scale: float = 1.0, x: float = 0.0) -> NDArray[np.float64]:
    matrix = np.diag([scale, scale, scale, 1.0])
    matrix[0, 3], matrix[2, 3] = x, z
    return matrix


def add(scene: Scene, z: float, through: Any, glow: Any = (0, 0, 0), **more: Any) -> None:
    """A sheet across all of the picture that sends light by itself and reflects none, unless more is said."""
    more = {"albedo": BLACK, "emission": [glow], **more}
    scene.add_instances(QUAD, place(z), transmittance=[np.broadcast_to(through, 3)], **more)


def add_floor(scene: Scene, glow: Any = (0, 0, 0), albedo: Any = (0, 0, 0), z: float = -1.0) -> None:
    scene.add_instances(QUAD, place(z, 5.0), [albedo], emission=[glow])


def picture(scene: Scene, half: float = 0.8, height: float = 10.0, **settings: Any) -> NDArray[np.float64]:
    settings = {"edge_samples": 1, **settings}
    return np.asarray(Frame(scene).render(camera(half, height), *SIZE, **settings), np.float64)


def over(layers: Sequence[tuple[Any, Any]], behind: Any) -> NDArray[np.float64]:
    """What (share let through, radiance) from the near end on leave to be seen."""
    out = np.array(behind, np.float64)
    for through, glow in reversed(layers):
        out = np.asarray(glow) + np.asarray(through) * out
    return out


@pytest.mark.parametrize("count", [1, 3, 300])
def test_sheets_are_laid_over_each_other_in_order_of_depth(count: int) -> None:
    random = np.random.default_rng(count)
    # So clear that the last still shows.
    layers = [(1.0 - random.random(3) * min(3.0 / count, 1.0), random.random(3) / count) for _ in range(count)]
    scene = Scene()
    depths = list(enumerate(np.linspace(5.0, -0.5, count)))
    random.shuffle(depths)
    for number, z in depths:
        add(scene, z, *layers[number])
    add_floor(scene, (2.0, 3.0, 4.0))
    np.testing.assert_allclose(
        picture(scene)[..., :3], np.broadcast_to(over(layers, (2.0, 3.0, 4.0)), (*SIZE, 3)), rtol=2e-5
    )


@pytest.mark.parametrize("apart", [1e-4, 1e-6, 0.0])
def test_no_sheet_is_lost_however_near_to_the_next(apart: float) -> None:
    scene = Scene()
    for number in range(5):
        add(scene, number * apart, (0.5, 0.6, 0.7))
    add_floor(scene, (1.0, 1.0, 1.0), z=-200.0)
    found = picture(scene, height=300.0)
    np.testing.assert_allclose(found[..., :3], np.broadcast_to(np.array((0.5, 0.6, 0.7)) ** 5, (*SIZE, 3)), rtol=1e-5)


def test_on_the_edge_between_two_triangles_a_sheet_is_met_once() -> None:
    """Rays that run exactly through the diagonal, and through the corner that four triangles share."""
    fan = Mesh(
        [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0], [0, 0, 0]], [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]
    )
    for mesh in (QUAD, fan):
        scene = Scene()
        scene.add_instances(mesh, np.eye(4), BLACK, transmittance=[[0.5] * 3])
        add_floor(scene, (1.0, 1.0, 1.0))
        for size in ((16, 16), (15, 15)):
            found = np.asarray(Frame(scene).render(camera(), *size, edge_samples=1))[..., :3]
            np.testing.assert_allclose(found, 0.5, rtol=1e-5)
        # In shadows, too: of rays from points of the floor that lie just below the diagonal.
        lit = Scene()
        lit.add_instances(mesh, np.eye(4), BLACK, transmittance=[[0.5] * 3], visibility=Visibility("unseen"))
        add_floor(lit, albedo=(1.0, 1.0, 1.0))
        lit.add_sun((0, 0, -1), (np.pi,) * 3)
        for size in ((16, 16), (15, 15)):
            found = np.asarray(Frame(lit).render(camera(), *size, edge_samples=1))[..., :3]
            np.testing.assert_allclose(found, 0.5, rtol=1e-5)


def test_without_anything_behind_it_is_in_the_alpha_as_much_as_it_hides() -> None:
    scene = Scene()
    add(scene, 1.0, (0.2, 0.5, 0.8), (1.0, 2.0, 3.0))
    add(scene, 0.0, (0.5, 0.5, 0.5))
    np.testing.assert_allclose(picture(scene), np.broadcast_to((1.0, 2.0, 3.0, 0.75), (*SIZE, 4)), rtol=1e-5)


def test_one_that_lets_nothing_through_is_a_solid_and_one_that_lets_all_through_is_not_there() -> None:
    def scene_of(card: bool, ghost: bool, through: Any | None) -> Scene:
        scene = Scene()
        if card:
            scene.add_instances(QUAD, place(1.0, 0.3), [[0.3, 0.5, 0.7]], transmittance=through)
        if ghost:
            scene.add_instances(QUAD, place(0.5, 0.6), BLACK, transmittance=[[1.0, 1.0, 1.0]])
        add_floor(scene, albedo=(0.8, 0.6, 0.4))
        scene.add_point((0.5, 0.7, 4.0), (40.0, 30.0, 20.0), radius=0.3)
        return scene

    plain = picture(scene_of(True, False, None), edge_samples=16)
    np.testing.assert_array_equal(picture(scene_of(True, False, [[0, 0, 0]]), edge_samples=16), plain)
    found = picture(scene_of(True, True, None), edge_samples=16)
    assert np.isfinite(found).all()
    np.testing.assert_allclose(found, plain, atol=1e-5 * plain.max())


@pytest.mark.parametrize(
    "albedo,gloss", [((0.6, 0.4, 0.2), None), ((0.2, 0.4, 0.6), (0.5, 0.4, 0.3, 1, 0.2, 0.2, 0, 1.5))]
)
def test_it_is_lit_as_what_is_opaque_on_both_sides(albedo: Any, gloss: Any) -> None:
    def scene_of(through: Any | None, turn: bool) -> Scene:
        scene = Scene()
        matrix = np.diag([1.0, -1.0, -1.0, 1.0]) if turn else np.eye(4)
        scene.add_instances(QUAD, matrix, [albedo], gloss=None if gloss is None else [gloss], transmittance=through)
        scene.add_instances(QUAD, place(2.0, 0.2, 0.3), [[1.0] * 3])  # throws a shadow
        scene.add_point((0.5, 0.7, 4.0), (40.0, 30.0, 20.0), radius=0.3)
        scene.add_sun((0.3, 0.2, -1.0), (1.0, 2.0, 3.0), angle=0.1)
        return scene

    for turn in (False, True):
        plain = picture(scene_of(None, turn))[..., :3]
        np.testing.assert_allclose(picture(scene_of([[0.3, 0.3, 0.3]], turn))[..., :3], plain, rtol=1e-5)
        assert plain.std() > 0.01


def sunlit(*cards: tuple[float, Any], reach: Reach | None = None, **flags: Any) -> NDArray[np.float64]:
    """The light on a white floor in the sun, under sheets that the camera does not see, over that of the open sky."""
    scene = Scene()
    for z, through in cards:
        add(scene, z, through, visibility=Visibility("unseen", **flags))
    add_floor(scene, albedo=(1.0, 1.0, 1.0))
    scene.add_sun((0, 0, -1), (np.pi,) * 3, reach=reach)
    return picture(scene)[..., :3]


def test_its_shadow_is_what_it_lets_through_of_each_colour() -> None:
    np.testing.assert_allclose(sunlit((1.0, (0.2, 0.5, 0.8))), np.broadcast_to((0.2, 0.5, 0.8), (*SIZE, 3)), rtol=1e-5)
    both = sunlit((1.0, (0.2, 0.5, 0.8)), (1.0 + 1e-6, (0.5, 0.5, 0.5)))
    np.testing.assert_allclose(both, np.broadcast_to((0.1, 0.25, 0.4), (*SIZE, 3)), rtol=1e-5)
    np.testing.assert_allclose(sunlit((1.0, (0.2, 0.5, 0.8)), hides=0), 1.0, rtol=1e-5)
    np.testing.assert_allclose(sunlit((1.0, (0.2, 0.5, 0.8)), hides=1, reach=Reach(hidden_by=2)), 1.0, rtol=1e-5)


def test_a_lamp_of_any_size_is_dimmed_by_what_covers_all_of_it() -> None:
    def lit(through: Any | None) -> NDArray[np.float64]:
        scene = Scene()
        if through is not None:
            add(scene, 0.5, through, visibility=Visibility("unseen"))
        add_floor(scene, albedo=(0.5, 0.5, 0.5))
        scene.add_area((0.2, 0.1, 2.0), (0.2, 0, 0), (0, 0.2, 0), (5.0, 5.0, 5.0))
        return picture(scene, half=0.3, edge_samples=16)[..., :3]

    np.testing.assert_allclose(lit((0.3, 0.6, 0.9)), lit(None) * (0.3, 0.6, 0.9), rtol=1e-4)


def test_copies_stand_wherever_they_are_put() -> None:
    """Instances, mirrored ones, and triangles of which some are opaque: as separate meshes would."""
    both = Mesh([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], [[0, 1, 2], [0, 2, 3]], material=[0, 1])
    halves = [Mesh([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], [triangle]) for triangle in ([0, 1, 2], [0, 2, 3])]
    places = np.stack([place(0.5, 0.4, 0.3), place(0.8, 0.4, -0.3) @ np.diag([-1.0, 1.0, 1.0, 1.0])])
    albedo, through = [[0.2, 0.3, 0.4], [0.6, 0.5, 0.4]], [[0.7, 0.6, 0.5], [0.0, 0.0, 0.0]]

    def scene_of(mixed: bool, instanced: bool) -> Scene:
        scene = Scene()
        for group in (places,) if instanced else places:
            if mixed:
                scene.add_instances(both, group, albedo, transmittance=through)
            else:
                for row, half in enumerate(halves):
                    scene.add_instances(half, group, [albedo[row]], transmittance=[through[row]])
        add_floor(scene, albedo=(0.8, 0.6, 0.4))
        scene.add_sun((0.2, 0.1, -1.0), (3.0, 3.0, 3.0))
        return scene

    wanted = picture(scene_of(False, False), edge_samples=16)
    for mixed, instanced in ((True, False), (False, True), (True, True)):
        np.testing.assert_allclose(picture(scene_of(mixed, instanced), edge_samples=16), wanted, atol=2e-5)


def test_in_smoke_it_hides_what_is_behind_and_nothing_before() -> None:
    depth = np.array((0.5, 0.25, 0.125))
    slab = np.diag([0.5, 0.5, 0.125, 1.0])
    slab[:3, 3] = -4.0, -4.0, -1.0  # 2 metres thick, a sheet in the middle
    glow, through = np.array((1.0, 2.0, 3.0)), np.array((0.6, 0.5, 0.4))
    scene = Scene()
    scene.add_medium(np.ones((16, 16, 16)), slab, scattering=(0, 0, 0), absorption=depth)
    add(scene, 0.0, through, glow)
    add_floor(scene, (4.0, 4.0, 4.0), z=-2.0)
    half = np.exp(-depth)
    np.testing.assert_allclose(
        picture(scene)[4:12, 4:12, :3], np.broadcast_to(half * (glow + through * half * 4.0), (8, 8, 3)), rtol=5e-3
    )


def test_edges_are_smooth() -> None:
    """A card turned by 30 degrees covers as many pixels as its area says, each in part."""
    scene = Scene()
    turned = place(1.0, 0.4)
    turned[:2, :2] = 0.4 * np.array([[0.866, -0.5], [0.5, 0.866]])
    scene.add_instances(QUAD, turned, BLACK, transmittance=[[0.5] * 3])
    add_floor(scene, (1.0, 1.0, 1.0))
    found = picture(scene, edge_samples=64)[..., 0]
    assert len(np.unique(found.round(3))) > 10
    area = 0.64 / (1.6 * 1.6)
    assert found.mean() == pytest.approx(1.0 - 0.5 * area, abs=2e-3)


def test_passes_tell_of_the_first_that_is_opaque_enough() -> None:
    scene = Scene()
    for z, through, number in ((2.0, 0.8, 3), (1.0, 0.4, 5)):
        add(scene, z, (through,) * 3, object_index=[number], material_index=[10 * number])
    add_floor(scene, (1.0, 1.0, 1.0))
    names = ["position", "object_index", "material_index", "mist", "normal"]
    mist: dict[str, Any] = {"mist": (0.0, 20.0, 1.0), "eye": (0, 0, 10), "axis": (0, 0, -1)}

    def passes(**settings: Any) -> dict[str, Any]:
        found = Frame(scene).passes(camera(), 4, 4, names, **mist, **settings)
        return {name: image[2, 2] for name, image in found.items()}

    found = passes()
    np.testing.assert_allclose(found["position"][2:], (1.0, 1.0), atol=1e-5)
    assert (found["object_index"], found["material_index"]) == (5, 50)
    np.testing.assert_allclose(found["normal"], (0, 0, 1), atol=1e-6)
    # Mist is that of all, by how much each shows: 8, 9 and 11 metres of 20.
    assert found["mist"] == pytest.approx(0.2 * 0.4 + 0.8 * (0.6 * 0.45 + 0.4 * 0.55), abs=1e-5)
    assert passes(least_alpha=0.0)["object_index"] == 3
    assert passes(least_alpha=0.9)["object_index"] == 0


def test_the_smoke_alone_is_without_them() -> None:
    def smoke_pass(card: bool) -> NDArray[np.float64]:
        scene = Scene()
        if card:
            add(scene, 1.0, (0.5, 0.6, 0.7), (1.0, 2.0, 3.0))
        add_floor(scene, (1.0, 1.0, 1.0))
        slab = np.diag([0.5, 0.5, 0.125, 1.0])
        slab[:3, 3] = -4.0, -4.0, 0.0
        scene.add_medium(np.ones((16, 16, 16)), slab, scattering=(0.2, 0.2, 0.2), absorption=(0.1, 0.2, 0.3))
        scene.add_sun((0.0, 1.0, 0.0), (3.0, 3.0, 3.0))  # the sheet throws no shadow
        return np.asarray(Frame(scene).passes(camera(), 8, 8, ["smoke"])["smoke"], np.float64)

    plain = smoke_pass(False)
    assert plain.min() > 0.005
    np.testing.assert_allclose(smoke_pass(True), plain, rtol=1e-4)


def test_surfaces_alone_have_their_sheets() -> None:
    scene = Scene()
    add(scene, 1.0, (0.2, 0.5, 0.8), (1.0, 2.0, 3.0))
    add_floor(scene, (1.0, 1.0, 1.0))
    scene.add_medium(np.ones((4, 4, 4)), place(2.0, 0.5), (1, 1, 1), (0, 0, 0))
    frame = Frame(scene)
    assert not frame.opaque
    found = np.asarray(frame.surfaces(camera(), *SIZE))
    np.testing.assert_allclose(found[..., :3], np.broadcast_to((1.2, 2.5, 3.8), (*SIZE, 3)), rtol=1e-5)


def test_over_another_picture_it_hides_smoke_and_shades_as_much_as_it_takes() -> None:
    """An overlay lies over a picture that shows sheets as solids."""
    scene = Scene()
    scene.add_instances(QUAD, place(1.0, 0.3), BLACK, transmittance=[[0.25] * 3])
    add_floor(scene, albedo=(1.0, 1.0, 1.0))
    scene.add_sun((0.5, 0.0, -1.0), (1.0, 1.0, 1.0))
    found = np.asarray(Frame(scene).surfaces(camera(2.0), 32, 32, output="all_shadows"))
    row = found[16, :, 0]
    assert row[16] == pytest.approx(0.0, abs=1e-5)  # the card itself
    shade = row[np.argmin(abs(np.linspace(-2, 2, 33)[:-1] + 1 / 16 - 1.0))]
    facing = 1.0 / np.sqrt(1.25)  # a share is one of the light on what faces the sun
    assert shade == pytest.approx(0.75 * facing, abs=1e-5)
    np.testing.assert_allclose(np.unique(row.round(4)), (0.0, 0.75 * facing), atol=1e-4)


def smoky(card: Any | None, sun: Any, z: float = 1.5, x: float = 0.0, **more: Any) -> NDArray[np.float64]:
    """Thick smoke in a sun from above, two metres high and below a sheet that the camera does not see, if any; from the
    side, without a floor: rows are heights from -0.8 to 0.8."""
    scene = Scene()
    if card is not None:
        scene.add_instances(
            QUAD, place(z, 2.0, x), BLACK, transmittance=[card], visibility=Visibility("unseen"), **more
        )
    box = np.diag([0.05, 0.05, 0.05, 1.0])
    box[:3, 3] = -1.0, -1.0, -1.0
    scene.add_medium(np.full((40, 40, 40), 1.0), box, scattering=(0.6, 0.6, 0.6), absorption=(0.2, 0.2, 0.2))
    scene.add_sun((0, 0, -1), sun)
    from_the_side = np.zeros((4, 4))
    from_the_side[0, 0] = from_the_side[1, 2] = 1.0 / 0.8
    from_the_side[2, 1], from_the_side[3, 3] = 0.1, 1.0
    return np.asarray(Frame(scene).render(Camera(from_the_side), *SIZE, edge_samples=1), np.float64)[..., :3]


def test_smoke_below_it_has_what_it_lets_through_of_each_colour() -> None:
    plain = smoky(None, (3.0, 3.0, 3.0))
    assert plain.min() > 0.01
    through = np.array((0.2, 0.5, 0.8))
    np.testing.assert_allclose(smoky(through, (3.0, 3.0, 3.0)), plain * through, rtol=2e-3)
    grey = smoky((0.3, 0.3, 0.3), (3.0, 3.0, 3.0))
    np.testing.assert_allclose(grey, plain * 0.3, rtol=2e-3)


def test_smoke_above_a_sheet_in_it_has_all_light() -> None:
    plain, card = smoky(None, (3.0, 3.0, 3.0)), smoky((0.2, 0.5, 0.8), (3.0, 3.0, 3.0), z=0.0)
    share = card / plain
    np.testing.assert_allclose(share[9:], 1.0, rtol=2e-3)
    np.testing.assert_allclose(share[:7], np.broadcast_to((0.2, 0.5, 0.8), (7, 16, 3)), rtol=2e-3)


def test_smoke_beside_its_shadow_has_all_light() -> None:
    plain, card = smoky(None, (3.0, 3.0, 3.0)), smoky((0.5, 0.5, 0.5), (3.0, 3.0, 3.0), x=2.0)
    share = card / plain  # from x = 0 on
    np.testing.assert_allclose(share[:, :7], 1.0, rtol=2e-3)
    np.testing.assert_allclose(share[:, 9:], 0.5, rtol=2e-3)
