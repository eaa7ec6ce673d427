# SPDX-License-Identifier: GPL-3.0-or-later
# Written by stub.py from the built module; do not edit.
from collections.abc import Callable, Sequence
from typing import Any, overload

import numpy
from numpy.typing import ArrayLike, NDArray

class Camera:
    """The rays of a projection."""

    def __init__(self, view_projection: ArrayLike) -> None: ...
    @property
    def corners(self) -> NDArray[numpy.float32]:
        """(6, 3): near0, near_u, near_v, far0, far_u, far_v of shaders/camera.glsl."""

class Exposure:
    """What a picture is taken with, where a Camera alone would be sharp and still."""

    def __init__(
        self,
        cameras: list[Any],
        lens_radius: float = 0.0,
        focus: float = 1.0,
        near: float = 0.0,
        blades: int = 0,
        rotation: float = 0.0,
        ratio: float = 1.0,
        shutter: ArrayLike | None = None,
    ) -> None: ...

class Frame:
    """Everything about a scene that does not depend on the camera, computed once."""

    def __init__(
        self,
        scene: Scene,
        coefficients: int | None = None,
        texels_per_cell: float = 1.0,
        steps_per_cell: float = 1.0,
        light_samples: int = 16,
        prepared: Prepared | None = None,
        basis: str = "cosine",
        ranges: str = "own",
        air_texels: int = 1024,
    ) -> None: ...
    @property
    def air(self) -> bool:
        """Whether air fills the world, or a mesh."""
    @property
    def drawable(self) -> bool:
        """Whether what is sorted can be drawn by a GPU, as sprites() and triangles(): none of it takes one colour
        more than another, there are no grids and no air to sort it with, and no surface behind it is held out or
        catches shadows.
        """
    def glance(
        self,
        camera: Camera,
        width: int,
        height: int,
        output: str = "picture",
        spacing: int = 4,
        shadow_strength: float | None = None,
    ) -> Any:
        """(height, width, 4) float32, for a camera that moves: one pixel of every spacing in either direction is
        traced, those between them where these bend or surfaces end, and the rest is interpolated. All lights are
        seen at their middles. "picture" is what render() makes, the other outputs what surfaces() makes.
        """
    @property
    def grey(self) -> bool:
        """Whether all smoke takes all colours alike: one march does."""
    def light_map(self, light: int = 0, sample: int = 0, medium: int = 0) -> LightMap:
        """The LightMap of a medium, or of particles, which follow the media, from one of the points that a light is
        sampled at; None where that light cannot meet it. Raises ValueError where there is no such light, sample
        or medium.
        """
    @property
    def lights(self) -> NDArray[numpy.float32]:
        """(n, 3, 4) float32: direction and 1 for a sun, else 0; position and the square of the light's size, as in
        falloff() of shaders/lights/light.glsl, or of the sine of a sun's radius; strength, and the number of its
        samples.
        """
    def measure(
        self,
        camera: Camera,
        picture: ArrayLike,
        pixels: int = 256,
        seed: int = 0,
        earlier: Measured | None = None,
        filter: str = "blackman_harris",
        filter_width: float = 1.5,
    ) -> Measured:
        """The error of a picture (height, width, 4) that render() or passes() of this frame made of a camera without
        lens and motion, a Measured. At about so many `pixels` of it, chosen by `seed` and by where it changes
        most, many samples are followed at fine steps, and from a part of these steps, and from surfaces, the way
        to a random point of each light is marched through the smoke instead of being looked up in light maps.
        What `earlier` frames found, a Measured, is counted with it. filter and filter_width are those of
        passes().
        """
    @property
    def media(self) -> list[Any]:
        """A list of LitMedium, those that hold any smoke and that the camera sees."""
    @property
    def opaque(self) -> bool:
        """Whether the first surface on each ray has an alpha of 1: none is transparent, held out, or catches
        shadows.
        """
    @property
    def origin(self) -> NDArray[numpy.float64]:
        """The scene's, (3,): the place in the world to which cameras and points are relative."""
    @property
    def particles(self) -> bool:
        """Whether the camera sees any particles."""
    def passes(
        self,
        camera: Camera | Exposure,
        width: int,
        height: int,
        names: Sequence[str],
        edge_samples: int = 16,
        progress: Callable[[float], object] | None = None,
        mist: ArrayLike | None = None,
        eye: ArrayLike = [0.0, 0.0, 0.0],
        axis: ArrayLike = [0.0, 0.0, 0.0],
        filter: str = "blackman_harris",
        filter_width: float = 1.5,
        least_alpha: float = 0.5,
    ) -> Any:
        """A dictionary of images (height, width, n) float32: "picture", which is what render() makes, and those of
        names. Of the first surface on each ray, through the middle of each pixel: "position" (4), in the scene's
        space, and 1 where there is a surface, 0 where there is none; "object_index" and "material_index" (1) as
        add_instances has them, else 0. Filtered as the picture is: "normal" (3), in the world and towards the
        eye; "mist" (1); "smoke" (4), premultiplied: what the smoke before the surface sends, and how much it
        hides; "smoke_shadow" (3), the share of a surface's radiance that smoke leaves it; "shadow" (3), the share
        of the light that it reflects that smoke and solids leave it, both also where something is held out or
        catches shadows. Where there is no light, as where there is no surface, the first is 1, for a product, and
        the second 0, as in Cycles.
        """
    def render(
        self,
        camera: Camera | Exposure,
        width: int,
        height: int,
        edge_samples: int = 16,
        progress: Callable[[float], object] | None = None,
    ) -> Any:
        """The finished image: (height, width, 4) float32, premultiplied scene-linear RGBA, row 0 at the bottom."""
    @property
    def sorted(self) -> bool:
        """Whether anything else than grids may lie before an opaque surface, such as transparent meshes, or air: no
        march through grids shows that.
        """
    def sprites(self, camera: Camera, past_smoke: bool = True) -> tuple[Any, ...]:
        """Of a drawable frame the particles that a camera sees, as Transparency of the add-on draws them: points (n,
        3); radius (n,); opacity (n,) through the middle; colour (n, 3), the radiance that each sends to the eye
        at an opacity of 1, past solids and, unless past_smoke says otherwise, past all smoke and particles.
        """
    @property
    def stages(self) -> dict:
        """The stages that ran so far, in order, and the seconds that each took: of "solids", "smoke", "particles",
        "world", "lights", "light maps" and "light volumes", when the frame was made; of "surfaces", "sheets",
        "slices" of particles, "march", "air", "merge" and "composite", in all pictures since, summed over the
        threads. What a scene does not need is not there.
        """
    @property
    def step_length(self) -> float:
        """Of the march along view rays, in cells."""
    def surfaces(
        self,
        camera: Camera,
        width: int,
        height: int,
        output: str = "radiance",
        edge_samples: int = 1,
        progress: Callable[[float], object] | None = None,
    ) -> Any:
        """(height, width, 4) float32: of the first surface what `output` says, and the distance to it through the
        pixel's centre in metres, the far plane's where there is none. "radiance": in the shadow of smoke and
        solids, but without the smoke between it and the eye; "opaque": the same without transparent meshes before
        it; "smoke_shadow": the share of the light on it that smoke takes, in [0, 1], of all that it would have if
        it faced every light; "all_shadows": the share that smoke and solids take.
        """
    def transmittance(self, points: ArrayLike, light: int = 0) -> NDArray[numpy.float32]:
        """The share of a light that the smoke lets through to each of points (..., 3): (..., 3), RGB; light is its
        number. Solids are left out. Raises ValueError where there is no such light.
        """
    def triangles(self, camera: Camera, width: int, height: int) -> tuple[Any, ...]:
        """Of a drawable frame the hair and the transparent meshes that a camera sees, as triangles for a picture of
        width x height pixels: corners (n, 3, 3); opacity (n,); colour (n, 3, 3), the radiance that each corner
        sends to the eye at an opacity of 1; strip (n, 3, 2), of hair how far each corner is from its middle, and
        half of its width, in pixels, else 0. Hair is strips that face the camera, wider than it by what a pixel
        sees around itself; meshes are cut to pieces that are small in the picture, since their light is straight
        between corners.
        """

class Grid:
    """Densities of smoke, cropped to the cells above empty_below (see emptiness)."""

    def __init__(
        self,
        density: ArrayLike,
        empty_below: float = 0.0,
        colour: ArrayLike | None = None,
        glow: ArrayLike | None = None,
    ) -> None: ...
    @property
    def amount(self) -> float:
        """The sum of all densities that are kept."""
    @property
    def brightest(self) -> NDArray[numpy.float32]:
        """(3,): the highest value of each channel of its colour, 1 where it has none."""
    @property
    def cells(self) -> int:
        """How many are kept, one empty cell around the smoke included; 0 where nothing can be seen of it. Where most
        of what lies between is empty, those of bricks of 9^3 cells, one of which is empty and stands for all that
        are.
        """
    @staticmethod
    def from_file(path: str, grid: str = "density", empty_below: float = 0.0, colour: str | None = None) -> Grid:
        """The Grid of what read_volume gives, without that array in between; colour, another grid of the file, of
        vectors or for grey of scalars, wherever it lies. Raises ValueError that names the file and the cause.
        """

class Image:
    """A picture on surfaces, with a pyramid of means of itself."""

    def __init__(
        self, pixels: ArrayLike, curved: bool = False, divided: bool = False, closest: bool = False
    ) -> None: ...
    def look_up(
        self,
        u: ArrayLike,
        v: ArrayLike,
        du: ArrayLike | None = None,
        dv: ArrayLike | None = None,
        interpolation: str = "linear",
        extension: str = "repeat",
    ) -> NDArray[numpy.float32]:
        """Linear colours and alpha (n, 4) at places u, v (n,), which are within [0, 1] on the picture. du and dv (n,
        2) are how far these move along both axes of a pixel, over which the mean is taken. interpolation is
        'closest', 'linear' or 'cubic', extension 'repeat', 'extend', 'clip' or 'mirror'. Where a place is not
        finite, all is 0.
        """
    @property
    def shape(self) -> tuple[Any, ...]:
        """Its rows and columns."""

class LearnedBasis:
    """The functions that learn_basis made from a sample of rays."""

    @property
    def coefficients(self) -> int:
        """How many functions there are."""
    @property
    def density(self) -> NDArray[numpy.float32]:
        """(coefficients, cells): F_k, constant over each cell."""
    @property
    def integral(self) -> NDArray[numpy.float32]:
        """(coefficients, cells + 1): G_k at the edges of the cells, straight between them."""

class LightMap:
    """What smoke there is along the rays of a light, of a frame."""

    @property
    def basis(self) -> Any:
        """As transmittance takes it: its name, a LearnedBasis, or 'curve', of RayStorage."""
    @property
    def bytes(self) -> int:
        """What the map takes, without its solids."""
    @property
    def coefficients(self) -> NDArray[numpy.float32]:
        """(height, width, n): of each ray's column density, metres times density, as project makes them. A copy.
        Raises ValueError of curves.
        """
    @property
    def range(self) -> NDArray[numpy.float32]:
        """(height, width, 2): low and high of each ray's series, as project takes them. A copy. Raises ValueError of
        curves.
        """
    @property
    def texels(self) -> NDArray[numpy.uint8]:
        """(height, width, colours, 20) uint8: curves of optical depth, in the one colour of grey smoke or in three,
        as RayStorage stores them. A copy. Raises ValueError of series.
        """
    @property
    def world_to_light(self) -> NDArray[numpy.float64]:
        """(4, 4): of a sun's map, to x and y across it and z along the light, all in [0, 1]; of others, to a frame
        with the light at the origin.
        """

class LitMedium:
    """A body of smoke of a frame, cropped, with the light that reaches it."""

    @property
    def anisotropy(self) -> float:
        """g of Henyey and Greenstein (1941)."""
    @property
    def clearance(self) -> NDArray[numpy.float32]:
        """(bz, by, bx), for each brick of 4^3 cells: negative where smoke may be met, else the number of cells that
        are surely empty in every direction.
        """
    @property
    def density(self) -> NDArray[numpy.float32]:
        """(nz, ny, nx). A copy."""
    @property
    def emission(self) -> NDArray[numpy.float32]:
        """(n, 3), that of Scene.add_medium; no rows without a glow."""
    @property
    def extinction(self) -> NDArray[numpy.float32]:
        """(3,), per metre and unit density."""
    @property
    def glow(self) -> Any:
        """(nz, ny, nx), that of Scene.add_medium; None where nothing glows. A copy."""
    @property
    def grid_to_world(self) -> NDArray[numpy.float64]:
        """(4, 4): from cells to metres in world space."""
    @property
    def light(self) -> NDArray[numpy.float32]:
        """(lights, nz, ny, nx, c): r, of which r (r + 1) is the optical depth towards each light, in the one colour
        of grey smoke or in three, and the share of the light's falloff that passes solids and the edges of its
        cone. A copy.
        """
    @property
    def ramp(self) -> NDArray[numpy.float32]:
        """(parts, 7, 3): the transfer function between its stops, as shaders/media/ramp.glsl has a Part; no parts
        where density is the density. A copy.
        """
    @property
    def scattering(self) -> NDArray[numpy.float32]:
        """(3,), per metre and unit density."""
    @property
    def tint(self) -> Any:
        """(nz, ny, nx, 3): density times the colour in which it scatters; None where that is white. A copy."""

class Measured:
    """What Frame.measure finds: the error of a picture against what it would be at converged settings, as the root of the mean squared difference of all pixels and colours over the mean of its colours."""

    @property
    def frames(self) -> int:
        """How many frames these are of."""
    @property
    def high(self) -> float:
        """See low."""
    @property
    def low(self) -> float:
        """With high, where the error is with a probability of 95 %."""
    @property
    def pixels(self) -> int:
        """How many were looked at, of all frames."""
    @property
    def reported(self) -> float:
        """The estimate."""
    @property
    def seconds(self) -> float:
        """That the last of them took."""
    @property
    def unmeasured(self) -> Sequence[str]:
        """What of the picture is taken for right."""

class Mesh:
    """Triangles that any number of objects may share, in a space of their own."""

    def __init__(
        self,
        vertices: ArrayLike,
        triangles: ArrayLike,
        normals: ArrayLike | None = None,
        material: ArrayLike | None = None,
        tangents: ArrayLike | None = None,
        channels: ArrayLike | None = None,
        moving: ArrayLike | None = None,
    ) -> None: ...
    @property
    def triangles(self) -> int:
        """How many there are."""

class Pattern:
    """What of a material varies over a surface, as a program."""

    def __init__(
        self,
        steps: ArrayLike,
        outputs: ArrayLike,
        constants: ArrayLike = [],
        tables: list[Any] = [],
        integers: ArrayLike | None = None,
        images: list[Any] = [],
    ) -> None: ...
    def at(
        self,
        mesh: Mesh,
        triangle: ArrayLike,
        u: ArrayLike,
        v: ArrayLike,
        to_world: ArrayLike | None = None,
        values: ArrayLike = [],
    ) -> numpy.ndarray:
        """(n, k): its outputs at places of a mesh, seen against their normals: triangle (n,), and on it u and v
        (n,), the shares of its second and third corner. to_world (4, 4); values, what it asks for of the mesh's
        place. Raises ValueError for what is not finite or not there.
        """
    def of(self, rows: ArrayLike) -> numpy.ndarray:
        """(n, k): its outputs where rows (n, m) are the mesh's channels; all else that it asks for is 0. Raises
        ValueError for too few channels.
        """
    @staticmethod
    def operations() -> Sequence[str]:
        """The names of operations, in the order of their numbers."""

class PreintegratedTable:
    """What a step of a ray sends to the eye, by the values at both its ends."""

    def __init__(
        self,
        transfer: TransferFunction,
        steps: ArrayLike,
        entries: int = 256,
        low: float = 0.0,
        high: float = 1.0,
        self_attenuation: str = "full",
    ) -> None: ...
    def look_up(self, front: ArrayLike, back: ArrayLike, step: int = 0) -> NDArray[numpy.float64]:
        """(..., 4): radiance, RGB, and transmittance, bilinear between entries; `step` is the number of one of
        steps.
        """
    def rebuild(self, transfer: TransferFunction) -> int:
        """Makes it, to the last bit, the table of another TransferFunction. Returns how many entries it went
        through: those whose values lie around what changed.
        """
    @property
    def values(self) -> NDArray[numpy.float32]:
        """(k, entries, entries, 4) float32, a copy: by step, value in front, value behind; radiance, RGB, and
        opacity.
        """

class Prepared:
    """What outlives a frame: the meshes, light maps and lit smoke of the last one, and the threads that make them, as many as `threads` says, or all for 0. Of the next frame only what has changed is made."""

    def __init__(self, threads: int = 0) -> None: ...
    @property
    def made(self) -> dict:
        """How many parts of each kind were ever made: what did not change is not made again."""

class RayStorage:
    """A way to store light rays in a few bytes each, chosen by choose_basis."""

    def __init__(self) -> None: ...
    @property
    def additive(self) -> bool:
        """Whether coefficients, before they are stored, add and filter."""
    @property
    def bytes(self) -> int:
        """A texel."""
    @property
    def coefficients(self) -> int:
        """Numbers a texel, besides its range and total."""
    @property
    def error(self) -> float:
        """Root mean square error of transmittance over the judging rays."""
    @property
    def name(self) -> str:
        """'curve', or a basis and its range: 'cosine-range', 'learned-both', ..."""
    @property
    def reason(self) -> str:
        """What was measured, against what; empty where nothing was."""
    def store(self, depth: ArrayLike, optical_depth: ArrayLike, width: float = 0.0) -> NDArray[numpy.uint8]:
        """(..., bytes) uint8 of absorbers as in project."""
    def transmittance(self, texels: ArrayLike, depth: ArrayLike) -> NDArray[numpy.float32]:
        """(..., d) float32 at depth (..., d) in [0, 1]."""

class Reach:
    """What a light reaches, and what hides it: sets, a bit each, of which an object must have one (Visibility); without a set nothing hides it. diffuse, gloss, smoke: whether it shows in what surfaces reflect diffusely, in their gloss, and in smoke; plate, whether it is a light of the plate, so that a catcher's shadows are missing light of it. Raises ValueError for a light that reaches nothing, and for more than 64 bits."""

    def __init__(
        self,
        lights: int = 1,
        hidden_by: int = 1,
        diffuse: bool = True,
        gloss: bool = True,
        smoke: bool = True,
        plate: bool = True,
    ) -> None: ...

class Scene:
    """Meshes, smoke and lights."""

    def __init__(self) -> None: ...
    def add_area(
        self,
        position: ArrayLike,
        across: ArrayLike,
        up: ArrayLike,
        radiance: ArrayLike,
        ellipse: bool = False,
        spread: float = 3.1415927410125732,
        reach: Reach | None = None,
    ) -> None:
        """Add a rectangle, or the ellipse in it: position (3,) of its middle; across (3,) and up (3,), half its
        axes, at right angles; radiance (3,) in W/(m^2 sr), straight ahead. It shines along cross(up, across),
        into the whole angle spread, radians, in which it fades as 1 - tan(angle) / tan(spread / 2). Raises
        ValueError for a light without area, and for axes that are not at right angles.
        """
    def add_fog(
        self,
        mesh: Mesh,
        to_world: ArrayLike,
        rayleigh: ArrayLike = [0.0, 0.0, 0.0],
        mie: ArrayLike = [0.0, 0.0, 0.0],
        absorption: ArrayLike = [0.0, 0.0, 0.0],
        emission: ArrayLike = [0.0, 0.0, 0.0],
        anisotropy: float = 0.0,
        phase: str = "henyey-greenstein",
        tint: ArrayLike = [1.0, 1.0, 1.0],
        visibility: Visibility | None = None,
    ) -> None:
        """Fill a closed Mesh, convex or not, with fog: even air that is as set_air has it, and dims all light that
        comes through it.
        """
    def add_instances(
        self,
        mesh: Mesh,
        to_world: ArrayLike,
        albedo: ArrayLike,
        gloss: ArrayLike | None = None,
        emission: ArrayLike | None = None,
        diffuse: ArrayLike | None = None,
        object_index: ArrayLike | None = None,
        material_index: ArrayLike | None = None,
        visibility: Visibility | None = None,
        transmittance: ArrayLike | None = None,
        patterns: list[Any] = [],
        values: ArrayLike | None = None,
        translucence: ArrayLike | None = None,
        sheen: ArrayLike | None = None,
        lamp: bool = False,
        moving: ArrayLike | None = None,
    ) -> None:
        """Add a Mesh in one place, to_world (4, 4), or in many, (n, 4, 4): from its own space to metres in the
        world. albedo (k, 3), gloss, emission (k, 3), diffuse (k, 2) and transmittance (k, 3) are those of
        add_mesh, a row for each material that the mesh names. object_index (n,), a number for each place, and
        material_index (k,) are what Frame.passes gives by these names; visibility, what it is to the camera and
        to lights, or all of that. patterns, a Pattern or None for each material, give what varies of these, which
        then are no more than usual of it: of a layer of gloss the index decides what it leaves. values (n, j) are
        what they ask for of each place. translucence (k, 3) in [0, 1], the share of light on the other side that
        leaves diffusely on this one. sheen (k, 5), what fibres add: a colour; 5 for Burley's (2012), 6 for
        Ashikhmin's velvet (2000), 7 for Zeltner, Burley and Chiang's (2022), of which all that comes leaves in
        the end where the colour is white; and a roughness in [0, 1]. lamp: what it emits is among the lights,
        too, so light that goes between surfaces (set_bounces) leaves it to these. moving: places as to_world has
        them, at even times while the shutter of an Exposure is open, an odd number of them. Raises ValueError as
        add_mesh does, and for too few rows.
        """
    def add_medium(
        self,
        density: Grid | ArrayLike,
        grid_to_world: ArrayLike,
        scattering: ArrayLike,
        absorption: ArrayLike,
        anisotropy: float = 0.0,
        colour: ArrayLike | None = None,
        visibility: Visibility | None = None,
        glow: ArrayLike | None = None,
        emission: ArrayLike | None = None,
        transfer: TransferFunction | None = None,
        radiated: TransferFunction | None = None,
    ) -> None:
        """Add a body of smoke, of which there may be 64; or a Grid that was made before. Where they overlap, their
        densities add.
        """
    def add_mesh(
        self,
        vertices: ArrayLike,
        triangles: ArrayLike,
        corner_normals: ArrayLike,
        material: ArrayLike,
        albedo: ArrayLike,
        gloss: ArrayLike | None = None,
        corner_tangents: ArrayLike | None = None,
        emission: ArrayLike | None = None,
        diffuse: ArrayLike | None = None,
        transmittance: ArrayLike | None = None,
    ) -> None:
        """Add triangles that reflect diffusely, and with gloss."""
    def add_particles(
        self,
        points: ArrayLike,
        radius: ArrayLike,
        opacity: ArrayLike,
        albedo: ArrayLike = [0.800000011920929, 0.800000011920929, 0.800000011920929],
        extinction: ArrayLike = [1.0, 1.0, 1.0],
        anisotropy: float = 0.0,
        visibility: Visibility | None = None,
    ) -> None:
        """Add smoke as soft puffs, which show and shade as such. Where they overlap, their densities add, with those
        of grids, too; so their order does not matter, and none begins at a sheet.
        """
    def add_point(
        self,
        position: ArrayLike,
        intensity: ArrayLike,
        radius: float = 0.0,
        direction: ArrayLike = [0.0, 0.0, -1.0],
        cone: float = 6.2831854820251465,
        blend: float = 0.0,
        facing_disk: bool = False,
        spot_cosine: bool = False,
        across: ArrayLike | None = None,
        reach: Reach | None = None,
        part: bool = False,
    ) -> None:
        """Add a point light: position (3,); intensity (3,) in W/sr; radius, metres, that of a sphere; and where
        cone, a whole angle in radians, is less than 2 pi, a spot that shines along direction (3,) and fades in
        over the share blend, in [0, 1], of 1 - cos(cone / 2). Some renderers differ: with facing_disk the sphere
        looks as large as a disk of its radius that faces the eye, and with spot_cosine a spot dims by the cosine
        to its axis, too. across (2, 3) are two axes that with the direction measure the cone, which is round
        where they are unit vectors across it, and narrower along longer ones. part says that it is one of several
        that stand for a fire: what they throw they blur for each other, so fewer points stand for it.
        """
    def add_polygon(self, corners: ArrayLike, radiance: ArrayLike, reach: Reach | None = None) -> None:
        """Add a polygon that shines from both its sides, as a mesh that glows does: corners (3 to 64, 3), in turn;
        radiance (3,) in W/(m^2 sr). One with more than four corners, or that is not convex, becomes several
        lights. It is not seen itself: that is add_mesh's emission. Raises ValueError for corners that are not
        flat, that hold no area, or whose edges cross.
        """
    def add_sky(self, radiance: Sky | ArrayLike, reach: Reach | None = None, gain: float = 1.0) -> None:
        """Add light from all around: its radiance (3,), the same in every direction, or a Sky; reach, what it
        reaches and what hides it, or all of that; gain, by what the radiance is multiplied. What the eye sees of
        it is set_background()'s.
        """
    def add_strands(
        self,
        points: ArrayLike,
        radius: ArrayLike,
        first: ArrayLike,
        fibre: ArrayLike | None = None,
        matt: ArrayLike | None = None,
        material: ArrayLike | None = None,
        smooth: bool = True,
        visibility: Visibility | None = None,
    ) -> int:
        """Add strands of hair: rows of keys, points (n, 3) in metres with a radius (n,) each. The keys of strand i
        are those from first[i] up to first[i + 1]; first (m + 1,) ends with n. Through them leads Catmull and
        Rom's curve, or where it is not smooth a straight line from one to the next. Returns how many strands have
        no two keys: they are left out.
        """
    def add_sun(
        self, direction: ArrayLike, irradiance: ArrayLike, angle: float = 0.0, reach: Reach | None = None
    ) -> None:
        """Add a sun: direction (3,) in which its light travels; irradiance (3,) in W/m^2 on a surface that faces it;
        angle, its angular diameter in radians; reach, what it reaches and what hides it, or all of that.
        """
    def set_air(
        self,
        rayleigh: ArrayLike = [0.0, 0.0, 0.0],
        mie: ArrayLike = [0.0, 0.0, 0.0],
        absorption: ArrayLike = [0.0, 0.0, 0.0],
        emission: ArrayLike = [0.0, 0.0, 0.0],
        anisotropy: float = 0.0,
        phase: str = "henyey-greenstein",
        scale_height: float = 0.0,
        ground: float = 0.0,
        tint: ArrayLike = [1.0, 1.0, 1.0],
    ) -> None:
        """Fill the world with air, which scatters the light of all lights on its way, once, and dims what lies in
        it.
        """
    def set_background(self, radiance: Sky | ArrayLike, alpha: float = 0.0, gain: float = 1.0) -> None:
        """Set the radiance (3,) where no surface is, or a Sky, times the gain, and the alpha there. It lights
        nothing.
        """
    def set_bounces(self, gloss: bool = False, diffuse: int = 0) -> None:
        """Set what surfaces send to each other; without it, they reflect lights alone."""
    def set_origin(self, origin: ArrayLike) -> None:
        """Say to which place (3,) in the world, metres, all that is added is relative: single precision knows a
        place to 1e-7 of its distance from there. Cameras are, too.
        """

class Sky:
    """A sky that differs from side to side."""

    def __init__(self, radiance: ArrayLike) -> None: ...
    @property
    def shape(self) -> tuple[Any, ...]:
        """Its rows and columns."""
    def suns(self) -> list[Any]:
        """What of it is so bright and narrow that it throws a shadow of its own, as add_sun's arguments: the
        direction of its light (3,), irradiance (3,), and angular diameter.
        """

class SolidMap:
    """The first solids that the light of a sun meets: the shadow map of light shafts."""

    def __init__(self, depth: ArrayLike, world_to_map: ArrayLike) -> None: ...
    @property
    def shape(self) -> tuple[Any, ...]:
        """(rows, columns)."""

class TransferFunction:
    """Extinction and emission of smoke as functions of one number: a ramp."""

    def __init__(
        self,
        stops: ArrayLike,
        extinction: ArrayLike,
        colour: ArrayLike,
        interpolation: str = "linear",
        associated: bool = True,
    ) -> None: ...
    def at(self, s: ArrayLike) -> NDArray[numpy.float64]:
        """(..., 4) float64: emission, RGB, and extinction, both per unit of length, at values (...)."""
    def integral(self, s: ArrayLike) -> NDArray[numpy.float64]:
        """(..., 4) float64: the integral of at() from the first stop to values (...), exact but for rounding."""
    def segment(
        self, front: ArrayLike, back: ArrayLike, length: float = 1.0, self_attenuation: str = "full"
    ) -> NDArray[numpy.float64]:
        """(..., 4) float64: what a length of smoke sends to the eye, radiance, RGB, and transmittance, where the
        value goes straight from front (...) to back (...). As entries of a PreintegratedTable, without a table.
        """

class Visibility:
    """What an object is to the camera and to lights."""

    def __init__(
        self, seen: str = "shown", lit_by: int = 18446744073709551615, hides: int = 18446744073709551615
    ) -> None: ...

def airlight(
    start: ArrayLike,
    end: ArrayLike,
    position: ArrayLike,
    extinction: float,
    anisotropy: float = 0.0,
    phase: str = "henyey-greenstein",
    scale_height: float = 0.0,
    ground: float = 0.0,
    radius: float = 0.0,
    direction: ArrayLike = [0.0, 0.0, -1.0],
    cone: float = 6.283185307179586,
    blend: float = 0.0,
    points: int = 16,
) -> NDArray[numpy.float32]:
    """(...) float32: radiance that air sends from the ways start (..., 3) to end (..., 3), metres, to their starts,
    lit by a lamp at position (3,) of intensity 1 W/sr without shadows, for a scattering of 1 per metre.
    """

def airlight_of_plate(
    start: ArrayLike,
    end: ArrayLike,
    position: ArrayLike,
    across: ArrayLike,
    up: ArrayLike,
    extinction: float,
    anisotropy: float = 0.0,
    phase: str = "henyey-greenstein",
    scale_height: float = 0.0,
    ground: float = 0.0,
    spread: float = 3.141592653589793,
    error: float = 0.001,
) -> NDArray[numpy.float32]:
    """(...) float32: the same of a rectangle with half axes across (3,) and up (3,), metres, of radiance 1 W/(m^2
    sr), that shines along their cross product into an angle `spread`, radians: as 16 to 256 points, which are
    enough where the last doubling along both axes changed no more than `error` of what is sent.
    """

def average_series(coefficients: ArrayLike, p: float = 1.0) -> Any:
    """A Fourier series with Lanczos' sigma factors, (sin x / x)^p of harmonic k at x = pi k / m, where m is the
    number of its terms: formulas 6-7 of Song (2021).
    """

def choose_basis(
    depth: ArrayLike, optical_depth: ArrayLike, bytes: int = 20, additive: bool = False, width: float = 0.0
) -> RayStorage:
    """The RayStorage that serves a sample of a scene's rays best in at most `bytes` a texel, and why."""

def choose_classification(
    density: ArrayLike,
    start: ArrayLike,
    end: ArrayLike,
    transfer: TransferFunction,
    step: float = 1.0,
    error: float = 0.001,
    entries: int = 256,
) -> tuple[Any, ...]:
    """The method of classify that a ramp needs, and the errors of those that step: root mean square over the rays by
    the mean radiance, against "split". The cheapest of them whose error is at most `error` and within a fiftieth
    of the best; where there is none, "split". The other arguments as in classify.
    """

def classify(
    density: ArrayLike,
    start: ArrayLike,
    end: ArrayLike,
    transfer: TransferFunction,
    method: str = "split",
    step: float = 1.0,
    entries: int = 256,
) -> tuple[Any, ...]:
    """What smoke sends along rays under a TransferFunction: (..., 4), radiance, RGB, and transmittance; and (...),
    how many samples of the smoke that took.
    """

def composite_fourier(depth: ArrayLike, alpha: ArrayLike, colour: ArrayLike, terms: int = 4, sigma: float = 1.0) -> Any:
    """Transparent fragments by a Fourier series, as published: Song, "order-independent transparency with Fourier
    series" (2021), formulas 3-13.
    """

def composite_nearest(
    depth: ArrayLike, alpha: ArrayLike, colour: ArrayLike, nearest: int = 4, harmonics: int = 1
) -> Any:
    """Transparent fragments without sorting: the nearest exactly, the others by one short series over their own
    depths.
    """

def composite_weighted(depth: ArrayLike, alpha: ArrayLike, colour: ArrayLike) -> Any:
    """Transparent fragments weighted by their depth and opacity alone: McGuire and Mara, "Phenomenological
    Transparency" (2017).
    """

def content_hash(*arrays: ArrayLike) -> bytes:
    """16 bytes that differ wherever arrays do: in type, shape or values (XXH3)."""

def depth_range(
    depth: ArrayLike, optical_depth: ArrayLike, kind: str = "minmax", q: float = 3.0, width: float = 0.0
) -> NDArray[numpy.float32]:
    """Low and high depth of the absorbers of each ray: (..., 2) float32, as a texel can store them."""

def depth_ranges(
    depth: ArrayLike,
    optical_depth: ArrayLike,
    tile: int = 0,
    reach: int = 1,
    kind: str = "minmax",
    q: float = 3.0,
    width: float = 0.0,
) -> NDArray[numpy.float32]:
    """The range (height, width, 2) that every tile of tile x tile rays shares, so that their coefficients filter;
    tile 0: the whole map.
    """

def diffuse_ellipse(centre: ArrayLike, u: ArrayLike, v: ArrayLike, normal: ArrayLike) -> Any:
    """Irradiance / pi at the origin from ellipses of radiance 1, both of whose sides shine: exact, horizon-cut ones
    included. centre, u, v as in ellipse_integral.
    """

def diffuse_polygon(
    polygons: ArrayLike, normal: ArrayLike, counts: ArrayLike | None = None, two_sided: bool = False
) -> Any:
    """Irradiance / pi at the origin, on a surface with `normal`, from polygons of radiance 1: exact (Lambert 1760).
    In [0, 1]. Arguments as in polygon_integral; what is below the horizon gives nothing.
    """

def diffuse_sphere(centre: ArrayLike, radius: ArrayLike, normal: ArrayLike) -> Any:
    """Irradiance / pi at the origin from spheres of radiance 1: exact, horizon-cut ones included (Snyder 1996).
    centre (..., 3), radius one or (...), normal (3,) or (..., 3). 1 inside the sphere.
    """

def double_moment(polygon: ArrayLike, axis: ArrayLike, exponent: int, b: ArrayLike) -> float:
    """The integral of (u.axis)^n (u.b) over the directions to one polygon (vertices, 3) in front of the axis's
    plane, whole n: Arvo's double moment (1995), exact. Negative for polygons seen from behind.
    """

def ellipse_integral(
    centre: ArrayLike, u: ArrayLike, v: ArrayLike, axis: ArrayLike, exponent: ArrayLike, normal: ArrayLike | None = None
) -> Any:
    """As polygon_integral, over ellipses, both of whose sides shine: centre (..., 3) and the half axes u and v, (3,)
    or (..., 3), perpendicular. Two poles from n = 9, integrated along the outline exactly, horizons included;
    below, 64 corners, which leave up to 2e-4 beside large lights.
    """

def emptiness(shape: Sequence[int], grid_to_world: ArrayLike, extinction: ArrayLike) -> float:
    """The density that could darken nothing by more than 1e-4 of optical depth along a grid's diagonal: what a frame
    takes for empty. shape (nz, ny, nx); extinction (3,), per metre and unit density; infinite where that is 0.
    """

def end_threads() -> bool:
    """Ends the threads that work for this module, until there is work again. False where a Prepared or a Frame is
    still there that has some. Done when Python exits, too.
    """

def filter_map(coefficients: ArrayLike, width: float, kind: str = "box", range: ArrayLike | None = None) -> Any:
    """A map of coefficients, filtered along both axes: the coefficients of filtered density, whatever the basis
    (Jansen and Bavoil 2010, section 3).
    """

def henyey_greenstein(cos_theta: ArrayLike, anisotropy: float = 0.0) -> Any:
    """Phase function of Henyey and Greenstein (1941), per steradian; cos_theta (...) is the cosine between the
    directions of travel before and after scattering, anisotropy g in (-1, 1).
    """

instruction_set: str

interface: str

def learn_basis(
    depth: ArrayLike,
    optical_depth: ArrayLike,
    coefficients: int = 15,
    range: ArrayLike | None = None,
    width: float = 0.0,
    cells: int = 64,
) -> LearnedBasis:
    """The basis in which rays like these need the fewest coefficients: Karhunen and Loeve's, of their cumulative
    optical depth on `cells` depths of each ray's range.
    """

def library_problem() -> str:
    """What is wrong with Embree or oneTBB as this process has them, or nothing: their versions are asked for, and
    one ray is traced.
    """

def microfacet_ellipse(
    centre: ArrayLike,
    u: ArrayLike,
    v: ArrayLike,
    view: ArrayLike,
    alpha: ArrayLike,
    brdf: str = "ggx",
    f0: float = 1.0,
    index: float = 0.0,
) -> Any:
    """As microfacet_polygon, of ellipses: centre (..., 3) and the half axes u and v, (3,) or (..., 3)."""

def microfacet_polygon(
    polygons: ArrayLike,
    view: ArrayLike,
    alpha: ArrayLike,
    brdf: str = "ggx",
    f0: float = 1.0,
    counts: ArrayLike | None = None,
    index: float = 0.0,
) -> Any:
    """The radiance that a rough surface at the origin reflects to the eye, of convex polygons of radiance 1 that
    shine to both sides: (...), float32 worked in float32, all else in float64.
    """

def microfacet_sphere(
    centre: ArrayLike,
    radius: ArrayLike,
    view: ArrayLike,
    alpha: ArrayLike,
    brdf: str = "ggx",
    f0: float = 1.0,
    index: float = 0.0,
) -> Any:
    """As microfacet_polygon, of spheres that do not hold the origin: centre (..., 3), radius one or (...)."""

def mipmaps(coefficients: ArrayLike, range: ArrayLike | None = None) -> list[Any]:
    """A list of maps, each half as large as the one before, rounded down, from (height, width, n) itself to (1, 1,
    n): means over the area that a texel covers. All have the same mean, odd sizes too. range as in filter_map.
    """

def pack(
    coefficients: ArrayLike, basis: str | LearnedBasis = "fourier", range: ArrayLike | None = None
) -> NDArray[numpy.uint8]:
    """Texels of 8 bits a coefficient: (..., bytes) uint8. Range in 2 x 16 bits, total as a half float, then the
    coefficients relative to the largest that the total allows; 'fourier', 'cosine' and learned bases leave out
    the first, which the total tells. So 15 of them take 20 bytes. Only for storage: texels do not add.
    """

def polygon_integral(
    polygons: ArrayLike,
    axis: ArrayLike,
    exponent: ArrayLike,
    method: str = "poles-2",
    normal: ArrayLike | None = None,
    counts: ArrayLike | None = None,
    two_sided: bool = False,
) -> Any:
    """(n + 1)/(2 pi) times the integral of (u.axis)^n over the directions u from the origin to convex polygons: the
    share, in [0, 1], of a Phong lobe that they fill. (...), float32 worked in float32, all else in float64.
    """

def product_of_lobes(axes: ArrayLike, exponents: ArrayLike) -> tuple[Any, ...]:
    """(axis, exponent, scale) of one lobe for a product of lobes: scale (u.axis)^exponent for the product of
    (u.axes[i])^exponents[i], as Lecocq et al. (2017), section 7, want it. Ours: both have their peak in one
    place, at one height and with one mean curvature. Good for lobes less than 75 degrees apart; at 85 degrees a
    fifth of it is wrong.
    """

def project(
    depth: ArrayLike,
    optical_depth: ArrayLike,
    coefficients: int | None = None,
    width: float = 0.0,
    basis: str | LearnedBasis = "fourier",
    range: ArrayLike | None = None,
) -> Any:
    """Coefficients of absorbers along light rays: eqs 1-2 and 5-6 of Jansen and Bavoil (2010), or their like."""

def read_volume(path: str, grid: str = "density") -> tuple[Any, ...]:
    """The active part of a grid of an OpenVDB file, of scalars (nz, ny, nx) or of vectors (nz, ny, nx, 3), and
    grid_to_object (4, 4), which takes cells to the file's own space. Raises ValueError that names the file and
    the cause.
    """

class reference:  # a module
    """The answers that the methods approximate: float64, as plain as the textbook, and slow."""

    @staticmethod
    def airlight(
        start: ArrayLike,
        end: ArrayLike,
        position: ArrayLike,
        extinction: float,
        anisotropy: float = 0.0,
        phase: str = "henyey-greenstein",
        scale_height: float = 0.0,
        ground: float = 0.0,
        radius: float = 0.0,
        direction: ArrayLike = [0.0, 0.0, -1.0],
        cone: float = 6.283185307179586,
        blend: float = 0.0,
    ) -> NDArray[numpy.float64]:
        """(...): what airlight() approximates, by adaptive quadrature along the ways and over the cap of the lamp
        that each place sees.
        """
    @staticmethod
    def airlight_of_plate(
        start: ArrayLike,
        end: ArrayLike,
        position: ArrayLike,
        across: ArrayLike,
        up: ArrayLike,
        extinction: float,
        anisotropy: float = 0.0,
        phase: str = "henyey-greenstein",
        scale_height: float = 0.0,
        ground: float = 0.0,
        spread: float = 3.141592653589793,
    ) -> NDArray[numpy.float64]:
        """(...): what airlight_of_plate() approximates, by adaptive quadrature over the plate at each place of a
        way.
        """
    @staticmethod
    def column(scene: Scene, start: ArrayLike, end: ArrayLike, medium: int = 0) -> NDArray[numpy.float64]:
        """The integral of one medium's density along segments, in metres times density. Exact but for rounding."""
    @staticmethod
    def ellipse_integral(
        centre: ArrayLike,
        u: ArrayLike,
        v: ArrayLike,
        axis: ArrayLike,
        exponent: ArrayLike,
        normal: ArrayLike | None = None,
    ) -> NDArray[numpy.float64]:
        """The same over ellipses. Arguments as in sfumato.ellipse_integral."""
    @staticmethod
    def microfacet_ellipse(
        centre: ArrayLike,
        u: ArrayLike,
        v: ArrayLike,
        view: ArrayLike,
        alpha: ArrayLike,
        brdf: str = "ggx",
        f0: float = 1.0,
        method: str = "outline",
        index: float = 0.0,
    ) -> NDArray[numpy.float64]:
        """What sfumato.microfacet_ellipse approximates; method as in microfacet_polygon."""
    @staticmethod
    def microfacet_polygon(
        polygons: ArrayLike,
        view: ArrayLike,
        alpha: ArrayLike,
        brdf: str = "ggx",
        f0: float = 1.0,
        counts: ArrayLike | None = None,
        method: str = "outline",
        index: float = 0.0,
    ) -> NDArray[numpy.float64]:
        """What sfumato.microfacet_polygon approximates, with the same arguments: (...) float64. method:"""
    @staticmethod
    def microfacet_sphere(
        centre: ArrayLike,
        radius: ArrayLike,
        view: ArrayLike,
        alpha: ArrayLike,
        brdf: str = "ggx",
        f0: float = 1.0,
        method: str = "outline",
        index: float = 0.0,
    ) -> NDArray[numpy.float64]:
        """What sfumato.microfacet_sphere approximates; method as in microfacet_polygon."""
    @staticmethod
    def polygon_integral(
        polygons: ArrayLike,
        axis: ArrayLike,
        exponent: ArrayLike,
        normal: ArrayLike | None = None,
        counts: ArrayLike | None = None,
        method: str = "boundary",
    ) -> NDArray[numpy.float64]:
        """(n + 1)/(2 pi) int (u.axis)^n du over convex polygons, whichever side they show; float64. Arguments as in
        sfumato.polygon_integral. method 'boundary': quadrature along the edges, any n; 'recurrence': exact, whole
        n; 'area': quadrature over the polygon, n up to a few hundred.
        """
    @staticmethod
    def render(
        scene: Scene,
        camera: Camera,
        width: int,
        height: int,
        sun_samples_per_axis: int = 8,
        step: float = 0.01,
        light_samples_per_axis: int = 1,
    ) -> NDArray[numpy.float64]:
        """The image of a scene with single scattering: (height, width, 4) float64, row 0 at the bottom."""
    @staticmethod
    def sent(
        transfer: TransferFunction, front: ArrayLike, back: ArrayLike, length: float = 1.0, intervals: int = 400
    ) -> NDArray[numpy.float64]:
        """(..., 4): TransferFunction.segment() by Simpson's rule, in so many intervals between any two stops."""
    @staticmethod
    def sent_along(
        transfer: TransferFunction, density: ArrayLike, start: ArrayLike, end: ArrayLike, points: int = 256
    ) -> NDArray[numpy.float64]:
        """(..., 4): what classify() approximates, by straight lines between so many points of each cell."""
    @staticmethod
    def sphere_integral(
        centre: ArrayLike, radius: ArrayLike, axis: ArrayLike, exponent: ArrayLike, normal: ArrayLike | None = None
    ) -> NDArray[numpy.float64]:
        """The same over spheres, by adaptive quadrature along their outlines. Arguments as in
        sfumato.sphere_integral.
        """
    @staticmethod
    def sunlight(
        start: ArrayLike,
        end: ArrayLike,
        direction: ArrayLike,
        extinction: float,
        anisotropy: float = 0.0,
        phase: str = "henyey-greenstein",
        scale_height: float = 0.0,
        ground: float = 0.0,
    ) -> NDArray[numpy.float64]:
        """(...): what sunlight() has in closed form, by adaptive quadrature of the density along the way and to the
        sun.
        """
    @staticmethod
    def table(
        transfer: TransferFunction, step: float, entries: int = 64, low: float = 0.0, high: float = 1.0
    ) -> NDArray[numpy.float64]:
        """(entries, entries, 4): radiance and transmittance, each entry by itself, slab by slab, in each of which
        extinction and emission are what they are in its middle.
        """
    @staticmethod
    def transmittance(depth: ArrayLike, alpha: ArrayLike, d: ArrayLike) -> NDArray[numpy.float64]:
        """The share of light left behind flat absorbers: the product of 1 - alpha over all whose depth is at most d."""

def shafts(
    distance: ArrayLike,
    camera: Camera,
    maps: list[Any],
    direction: ArrayLike,
    irradiance: ArrayLike,
    rayleigh: ArrayLike = [0.0, 0.0, 0.0],
    mie: ArrayLike = [0.0, 0.0, 0.0],
    absorption: ArrayLike = [0.0, 0.0, 0.0],
    anisotropy: float = 0.0,
    method: str = "minmax",
) -> tuple[Any, ...]:
    """What even air scatters of suns to the eye, once, where solids leave it lit: radiance (rows, columns, 3); how
    many texels, or bounds of some, were looked at; and how many rays were followed.
    """

def sphere_integral(
    centre: ArrayLike, radius: ArrayLike, axis: ArrayLike, exponent: ArrayLike, normal: ArrayLike | None = None
) -> Any:
    """As polygon_integral, over spheres that do not hold the origin: centre (..., 3), radius one or (...)."""

def sunlight(
    start: ArrayLike,
    end: ArrayLike,
    direction: ArrayLike,
    extinction: float,
    anisotropy: float = 0.0,
    phase: str = "henyey-greenstein",
    scale_height: float = 0.0,
    ground: float = 0.0,
) -> NDArray[numpy.float32]:
    """(...) float32: the same of a sun that shines along direction (3,) with an irradiance of 1 W/m^2, in closed
    form.
    """

def transmittance(
    coefficients: ArrayLike,
    depth: ArrayLike,
    basis: str | LearnedBasis = "fourier",
    range: ArrayLike | None = None,
    evaluator: str = "clamp",
) -> Any:
    """The share of light that reaches each depth: exp of minus eq 3 of Jansen and Bavoil (2010)."""

def transmittance_before(
    coefficients: ArrayLike,
    depth: ArrayLike,
    optical_depth: ArrayLike,
    basis: str | LearnedBasis = "fourier",
    range: ArrayLike | None = None,
    width: float = 0.0,
) -> Any:
    """The share of light that reaches the front of receivers which are among the absorbers, such as strands of hair:
    what the series holds of a receiver's own optical depth is taken off (shaders/rays/opacity.glsl,
    self_harmonic).
    """

def unpack(texels: ArrayLike, basis: str | LearnedBasis = "fourier") -> tuple[Any, ...]:
    """The coefficients (..., n) and range (..., 2) of texels that pack made with the same basis."""

def unreadable_picture(path: str) -> str | None:
    """Why a picture cannot be read whole, naming its file; None where all its pixels can. Of a format that is not
    known here only whether there is a file that holds something.
    """

def volume_header(path: str, grid: str = "density") -> tuple[Any, ...]:
    """Of what read_volume gives, the density's shape (nz, ny, nx) and grid_to_object (4, 4), read from the file's
    header alone where it has them. Raises ValueError as read_volume does.
    """
