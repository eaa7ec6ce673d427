# SPDX-License-Identifier: GPL-3.0-or-later
"""What the camera does not see, lights do not reach and does not hide lights: as if it were not there for just those."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from sfumato import Camera, Frame, Mesh, Prepared, Reach, Scene, Visibility, reference

SIZE = 32, 24
# From above onto 4 by 3 metres, from 4 metres up.
CAMERA = Camera(np.diag([0.5, 1.0 / 1.5, -0.2, 1.0]))
QUAD = Mesh([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], [[0, 1, 2], [0, 2, 3]])
FLOOR_COLOUR, CARD_COLOUR = [0.8, 0.6, 0.4], [0.3, 0.5, 0.7]
GRID_TO_WORLD = np.diag([0.1, 0.1, 0.1, 1.0])
GRID_TO_WORLD[:3, 3] = -1.6, -0.4, 1.0
SMOKE = np.random.default_rng(5).random((8, 8, 8)) * 2.0

Flags = Visibility | None


def placed(x: float, z: float, scale: float) -> NDArray[np.float64]:
    matrix = np.diag([scale, scale, scale, 1.0])
    matrix[:3, 3] = x, 0.0, z
    return matrix


def scene_of(
    floor: Flags = None,
    card: Flags = None,
    smoke: Flags = None,
    sun: Reach | None = None,
    lamp: Reach | None = None,
    without: str = "",
) -> Scene:
    """A floor, a card above it on the right and smoke on the left, a sun whose shadows fall beside them and a lamp."""
    scene = Scene()
    things: dict[str, Callable[[], None]] = {
        "floor": lambda: scene.add_instances(QUAD, placed(0.0, 0.0, 5.0), [FLOOR_COLOUR], visibility=floor),
        "card": lambda: scene.add_instances(QUAD, placed(1.0, 1.0, 0.4), [CARD_COLOUR], visibility=card),
        "smoke": lambda: scene.add_medium(SMOKE, GRID_TO_WORLD, (1, 2, 3), (1, 1, 1), visibility=smoke),
        "sun": lambda: scene.add_sun((0.0, -0.7, -1.0), (3, 3, 3), reach=sun),
        "lamp": lambda: scene.add_point((0.0, 1.0, 3.0), (4, 3, 2), reach=lamp),
    }
    for name, add in things.items():
        if name not in without:
            add()
    return scene


def picture(scene: Scene, prepared: Any = None) -> NDArray[np.float64]:
    frame = Frame(scene, prepared=prepared)
    return np.asarray(frame.render(CAMERA, *SIZE, edge_samples=1), np.float64)


PLAIN = picture(scene_of())
# The card's own pixels, without its rim, and all pixels but those, the rim and the smoke.
_X, _Y = np.meshgrid(
    np.linspace(-2, 2, SIZE[0] + 1)[:-1] + 2 / SIZE[0], np.linspace(-1.5, 1.5, SIZE[1] + 1)[:-1] + 1.5 / SIZE[1]
)
CARD = (abs(_X - 1.0) < 0.3) & (abs(_Y) < 0.3)
BESIDE = ((abs(_X - 1.0) > 0.5) | (abs(_Y) > 0.5)) & ((abs(_X + 1.2) > 0.5) | (abs(_Y) > 0.5))


def require_same(found: NDArray[np.float64], expected: NDArray[np.float64], where: Any = ...) -> None:
    np.testing.assert_allclose(found[where], expected[where], atol=1e-6)


def test_flags_that_say_nothing_change_nothing() -> None:
    plain = picture(scene_of(Visibility(), Visibility(), Visibility(), Reach(), Reach()))
    np.testing.assert_array_equal(plain, PLAIN)


def test_the_unseen_still_throws_its_shadow() -> None:
    unseen = picture(scene_of(card=Visibility("unseen")))
    require_same(unseen, PLAIN, BESIDE)
    assert abs(unseen - PLAIN)[CARD].min(axis=0)[:3].max() > 0.01, "the floor is seen in its place"
    nothing = picture(scene_of(card=Visibility("unseen", hides=0)))
    np.testing.assert_array_equal(nothing, picture(scene_of(without="card")))


def test_what_hides_nothing_throws_no_shadow() -> None:
    bare = picture(scene_of(without="card"))
    require_same(picture(scene_of(card=Visibility(hides=0))), bare, BESIDE)
    assert abs(bare - PLAIN)[BESIDE].max() > 0.1


def test_a_light_without_shadows_is_as_if_nothing_else_were_there() -> None:
    alone = picture(scene_of(without="card smoke lamp"))
    found = picture(scene_of(sun=Reach(hidden_by=0), without="lamp"))
    require_same(found, alone, BESIDE)


def test_what_a_light_does_not_reach_has_only_the_others() -> None:
    linked = picture(scene_of(card=Visibility(lit_by=1), sun=Reach(lights=2)))
    require_same(linked, PLAIN, BESIDE)
    require_same(linked, picture(scene_of(without="sun")), CARD)
    assert abs(linked - PLAIN)[CARD].max() > 0.1


def test_what_is_linked_as_no_blocker_hides_all_lights_but_one() -> None:
    linked = picture(scene_of(card=Visibility(hides=1), sun=Reach(hidden_by=2)))
    of_the_sun = picture(scene_of(without="card lamp")) - picture(scene_of(without="card lamp sun"))
    of_the_lamp = picture(scene_of(without="sun"))
    require_same(linked[..., :3], (of_the_sun + of_the_lamp)[..., :3], BESIDE)


def test_the_shadow_of_smoke_by_light() -> None:
    frame = Frame(scene_of(smoke=Visibility(hides=1), sun=Reach(hidden_by=2)))
    behind = np.array([[-1.2, -0.98, 0.0], [-1.2, -0.9, 0.0]])  # where the sun's shadow falls
    np.testing.assert_array_equal(frame.transmittance(behind, light=0), 1.0)
    below = np.array([[-1.5, -0.4, 0.0]])  # the lamp's
    np.testing.assert_allclose(frame.transmittance(below, light=1), Frame(scene_of()).transmittance(below, light=1))
    assert frame.transmittance(below, light=1).max() < 0.9
    assert frame.light_map(light=0) is None and frame.light_map(light=1) is not None


@pytest.mark.parametrize("unseen", [{"lamp": Reach(lights=2)}, {"lamp": Reach(diffuse=False)}])
def test_a_share_in_shadow_is_of_the_lights_that_reach_a_surface(unseen: dict[str, Any]) -> None:
    floor = Visibility(lit_by=1)

    def shadow(scene: Scene) -> NDArray[np.float64]:
        return np.asarray(Frame(scene).surfaces(CAMERA, *SIZE, output="smoke_shadow"), np.float64)

    alone = shadow(scene_of(floor=floor, without="card lamp"))
    assert alone[..., :3].max() > 0.1
    require_same(shadow(scene_of(floor=floor, without="card", **unseen)), alone)


@pytest.mark.parametrize("seen", ["catcher", "holdout"])
def test_the_shadows_of_a_plate_are_those_of_what_stands_there(seen: str) -> None:
    found = []
    for floor in (None, Visibility(seen=seen)):
        frame = Frame(scene_of(floor=floor, without="card"))
        found.append(frame.passes(CAMERA, *SIZE, ["smoke_shadow", "shadow"], edge_samples=1))
    for name in ("smoke_shadow", "shadow"):
        assert found[0][name].min() < 0.9
        require_same(found[1][name], found[0][name])


@pytest.mark.parametrize(
    ("flags", "name"),
    [
        ({"card": Visibility(seen="holdout")}, "visibility of mesh 1"),
        ({"smoke": Visibility(hides=2)}, "visibility of medium 0"),
        ({"lamp": Reach(gloss=False)}, "reach of light 1"),
    ],
)
def test_the_judge_refuses_what_it_does_not_know(flags: dict[str, Any], name: str) -> None:
    with pytest.raises(ValueError, match=name):
        reference.render(scene_of(**flags), CAMERA, 2, 2)


def test_smoke_that_is_not_reached_has_only_the_others() -> None:
    ways: list[dict[str, Any]] = [
        {"sun": Reach(smoke=False)},
        {"sun": Reach(lights=2), "smoke": Visibility(lit_by=1)},
    ]
    for flags in ways:
        unlit = picture(scene_of(**flags, without="floor"))
        require_same(unlit, picture(scene_of(without="floor sun")), (_X < 0.0))
        assert abs(unlit - picture(scene_of(without="floor"))).max() > 0.1


def test_smoke_before_a_solid_stays_dark_behind_it_without_the_smoke_s_own_shadow() -> None:
    """Solids still hide a light that the smoke does not hide."""
    scene = scene_of(smoke=Visibility(hides=0), without="floor lamp")
    scene.add_instances(QUAD, placed(-1.2, 3.0, 3.0), [[0.0, 0.0, 0.0]], visibility=Visibility("unseen"))
    assert picture(scene)[..., :3].max() == 0.0


def test_smoke_that_the_camera_does_not_see_still_throws_its_shadow() -> None:
    unseen = Frame(scene_of(smoke=Visibility("unseen")))
    expected = Frame(scene_of()).surfaces(CAMERA, *SIZE)[..., :3]
    np.testing.assert_array_equal(np.asarray(unseen.render(CAMERA, *SIZE, edge_samples=1))[..., :3], expected)
    assert not unseen.media


def test_light_that_shows_in_gloss_or_diffusely_alone() -> None:
    def picture_of(**shows: bool) -> NDArray[np.float64]:
        scene = Scene()
        gloss = [[0.04, 0.04, 0.04, 1.0, 0.2, 0.2, 0.0, 1.5]]
        scene.add_instances(QUAD, placed(0.0, 0.0, 5.0), [FLOOR_COLOUR], gloss)
        scene.add_point((0.0, 1.0, 3.0), (4, 3, 2), radius=0.3, reach=Reach(**shows))
        return picture(scene)[..., :3]

    whole, diffuse, gloss = picture_of(), picture_of(gloss=False), picture_of(diffuse=False)
    np.testing.assert_allclose(diffuse + gloss, whole, rtol=1e-5)
    assert min(diffuse.max(), gloss.max()) > 0.02


def test_a_holdout_cuts_a_hole_behind_the_smoke() -> None:
    held = picture(scene_of(floor=Visibility("holdout")))
    nothing = picture(scene_of(without="floor"))
    smoky = (abs(_X + 1.2) < 0.3) & (abs(_Y) < 0.3)
    np.testing.assert_allclose(held[smoky], nothing[smoky], atol=1e-5)
    require_same(held, PLAIN, CARD)
    assert not held[BESIDE].any()


def test_before_an_opaque_backdrop_a_holdout_is_a_hole_still() -> None:
    scene = scene_of(floor=Visibility("holdout"), without="smoke")
    scene.set_background((0.2, 0.3, 0.4), alpha=1)
    held = picture(scene)
    assert not held[BESIDE].any() and (held[CARD][:, 3] == 1.0).all()


def test_a_catcher_shows_the_light_that_is_missing() -> None:
    caught = picture(scene_of(floor=Visibility("catcher")))
    alone = picture(scene_of(without="card smoke"))
    missing = 1.0 - (PLAIN / alone)[..., :3].mean(axis=-1)
    np.testing.assert_allclose(caught[BESIDE][:, 3], missing[BESIDE], atol=1e-5)
    assert missing[BESIDE].max() > 0.3 and not caught[BESIDE][:, :3].any()
    require_same(caught, PLAIN, CARD)


def test_before_an_opaque_backdrop_a_catcher_dims_it() -> None:
    scene = scene_of(floor=Visibility("catcher"))
    scene.set_background((0.2, 0.3, 0.4), alpha=1)
    expected = np.minimum(PLAIN / picture(scene_of(without="card smoke")), 1.0)[..., :3] * (0.2, 0.3, 0.4)
    np.testing.assert_allclose(picture(scene)[BESIDE][:, :3], expected[BESIDE], atol=1e-5)


def test_catchers_throw_no_shadow_on_each_other_that_others_do_not() -> None:
    both = picture(scene_of(floor=Visibility("catcher"), card=Visibility("catcher"), without="smoke"))
    np.testing.assert_allclose(both, 0.0, atol=1e-6)


def test_light_that_is_not_of_the_plate_takes_nothing_from_it() -> None:
    """Beside a sun of the plate a lamp of its own brightens, and its shadow only takes from what it brought."""
    caught = picture(scene_of(floor=Visibility("catcher"), lamp=Reach(plate=False), without="smoke"))
    of_the_sun = picture(scene_of(without="card smoke lamp"))
    whole = picture(scene_of(without="smoke"))
    missing = 1.0 - np.minimum(whole / of_the_sun, 1.0)[..., :3].mean(axis=-1)
    np.testing.assert_allclose(caught[BESIDE][:, 3], missing[BESIDE], atol=1e-5)


def test_what_is_kept_of_another_scene_s_parts_knows_the_flags() -> None:
    prepared = Prepared()
    scenes = [
        scene_of(),
        scene_of(card=Visibility("unseen")),
        scene_of(card=Visibility(hides=0)),
        scene_of(smoke=Visibility(hides=0)),
        scene_of(sun=Reach(smoke=False)),
        scene_of(sun=Reach(hidden_by=0)),
        scene_of(smoke=Visibility(lit_by=2), sun=Reach(lights=2)),
    ]
    for scene in [*scenes, *scenes]:
        np.testing.assert_array_equal(picture(scene, prepared), picture(scene))


def test_only_holdouts_and_catchers_before_a_transparent_film_have_an_alpha() -> None:
    assert Frame(scene_of(card=Visibility("unseen"))).opaque
    for seen in ("holdout", "catcher"):
        scene = scene_of(card=Visibility(seen))
        assert not Frame(scene).opaque
        scene.set_background((0, 0, 0), alpha=1)
        assert Frame(scene).opaque


@pytest.mark.parametrize(
    ("call", "name", "value"),
    [
        (lambda: Visibility("hidden"), "seen", "hidden"),
        (lambda: Visibility(lit_by=-1), "lit_by", "-1"),
        (lambda: Visibility(hides=2**64), "hides", "18446744073709551616"),
        (lambda: Reach(lights=0), "lights", "0"),
        (lambda: Reach(lights=2**64), "lights", "18446744073709551616"),
        (lambda: Reach(hidden_by=-1), "hidden_by", "-1"),
        (lambda: scene_of(smoke=Visibility("holdout")), "seen", "unseen"),
        (lambda: scene_of(smoke=Visibility("catcher")), "seen", "unseen"),
        (lambda: Scene().set_background((0, 0, 0), alpha=1.5), "alpha", "1.5"),
    ],
)
def test_wrong_flags_are_named(call: Callable[[], Any], name: str, value: str) -> None:
    with pytest.raises(ValueError) as caught:
        call()
    assert name in str(caught.value) and value in str(caught.value)
