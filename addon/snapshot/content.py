"""The content of a scene as frozen values: meshes, images, materials, instances, lights, world.

Lengths are in Blender units, which the engine takes as metres as Cycles does; matrices act on
column vectors; images have their first row at the bottom, as in Blender. Every array is
read-only by agreement. Large parts (meshes, images, surfaces) carry a `uid`: the same uid means the
same content, so that buffers on the graphics device are reused and a change is found by comparing
snapshots.
"""

import itertools
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from .boxes import instance_boxes
from .surface_graph import REC709_LUMINANCE, SurfaceGraph

_uids = itertools.count(1)


def next_uid():
    """Return a number that no other part of this process' snapshots has."""
    return next(_uids)


@dataclass(frozen=True, eq=False)
class MeshSnapshot:
    """Triangles with per-vertex attributes, in object space.

    Parameters
    ----------
    uid : int
    name : str
        For messages.
    positions : ndarray of shape (V, 3)
        float32.
    triangles : ndarray of shape (T, 3)
        int32 vertex indices, sorted by material slot.
    slots : tuple of (int, int, int)
        Material slot, first triangle, number of triangles.
    attributes : dict of str to ndarray
        float32 of shape (V, k): ``"normal"`` (k = 3), ``"generated"`` (3, the generated texture
        coordinates), ``"uv:NAME"`` (2), ``"tangent:NAME"`` (4: unit tangent of a UV map, and the
        sign of the other one), ``"color:NAME"`` (4, scene linear). An empty NAME is the active one.
    motion : tuple of two ndarray of shape (V, 3) or None
        Positions in the previous and the next frame, where the mesh deforms.
    rest : ndarray of shape (V, 3) or None
        Positions before any deformation, the same in every frame, where Blender knows them; None
        where it does not or nothing deforms the mesh. The levels of detail are made from them.
    """

    uid: int
    name: str
    positions: np.ndarray
    triangles: np.ndarray
    slots: tuple[tuple[int, int, int], ...]
    attributes: dict[str, np.ndarray] = field(default_factory=dict)
    motion: tuple[np.ndarray, np.ndarray] | None = None
    rest: np.ndarray | None = None

    @cached_property
    def triangle_area(self):
        """Mean area of the triangles, in squared units of the object."""
        a, b, c = (self.positions[self.triangles[:, i]].astype(np.float64) for i in range(3))
        areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
        return 0.5 * float(areas.mean()) if len(areas) else 0.0

    @cached_property
    def peaks(self):
        """Largest absolute value of each attribute, by its key."""
        return {k: float(np.abs(v).max(initial=0.0)) for k, v in self.attributes.items()}

    @cached_property
    def bounds(self):
        """Lower and upper corner of the triangles, shape (2, 3)."""
        if len(self.triangles) == 0:
            return np.zeros((2, 3), np.float32)
        used = np.zeros(len(self.positions), bool)
        used[self.triangles.ravel()] = True
        # Loose vertices are rare: nothing is copied without them.
        shown = self.positions if used.all() else self.positions[used]
        return np.stack([shown.min(axis=0), shown.max(axis=0)])


def decode_srgb(encoded):
    """Return the scene-linear values of sRGB encoded ones (IEC 61966-2-1), also beyond 0 to 1."""
    high = ((np.maximum(encoded, 0.0) + 0.055) / 1.055) ** 2.4
    return np.where(encoded < 0.04045, encoded / 12.92, high)


@dataclass(frozen=True, eq=False)
class ImageSnapshot:
    """Pixels of an image, as Blender stores them.

    Parameters
    ----------
    uid : int
    name : str
    pixels : ndarray of shape (height, width, 4)
        uint8 in the image's own encoding, or float32, finite.
    srgb : bool
        They are sRGB encoded, and decoded after interpolation, as Cycles does; else float pixels
        are scene linear.
    """

    uid: int
    name: str
    pixels: np.ndarray
    srgb: bool = False

    @cached_property
    def peak(self):
        """Largest value of any colour channel; at least white."""
        if self.pixels.dtype == np.uint8:
            return 1.0
        peak = np.abs(self.pixels[..., :3]).max(initial=0.0)
        return max(float(decode_srgb(peak) if self.srgb else peak), 1.0)

    def linear_colors(self):
        """Return its colours scene linear, shape (height, width, 3), float32."""
        if self.pixels.dtype != np.uint8:
            colors = np.ascontiguousarray(self.pixels[..., :3], np.float32)
            return decode_srgb(colors).astype(np.float32) if self.srgb else colors
        levels = np.arange(256, dtype=np.float64) / 255.0
        if self.srgb:
            levels = decode_srgb(levels)
        return np.take(levels.astype(np.float32), self.pixels[..., :3])


@dataclass(frozen=True, eq=False)
class MaterialSnapshot:
    """A surface.

    Parameters
    ----------
    uid : int
    name : str
    graph : SurfaceGraph
    cryptomatte_id : float
        Hash of the name as the Cryptomatte specification defines it.
    highlights : bool
        Its light may be drawn as bokeh.
    """

    uid: int
    name: str
    graph: SurfaceGraph
    cryptomatte_id: float = 0.0
    highlights: bool = True


@dataclass(frozen=True, eq=False)
class InstanceTable:
    """One row for each drawn copy of a mesh.

    Parameters
    ----------
    world : ndarray of shape (I, 4, 4)
        float32, object to world.
    previous_world, next_world : ndarray of shape (I, 4, 4) or None
        The same in the neighbouring frames, when motion was asked for.
    cryptomatte_id : ndarray of shape (I,)
        float32, hash of the object's name.
    names : tuple of str
        Of the objects, one a row, for Cryptomatte's manifest; empty when that was not asked for.
    looks : ndarray of shape (I, 6) or None
        float32. What nodes read of an object: its colour and opacity, a random number from 0 to 1,
        its pass index. None counts as zeros.
    """

    world: np.ndarray
    cryptomatte_id: np.ndarray
    previous_world: np.ndarray | None = None
    next_world: np.ndarray | None = None
    names: tuple[str, ...] = ()
    looks: np.ndarray | None = None


@dataclass(frozen=True)
class InstanceGroup:
    """A run of rows of the instance table that share mesh, materials and visibility.

    Parameters
    ----------
    mesh : int
        `MeshSnapshot.uid`.
    materials : tuple of int
        `MaterialSnapshot.uid` for each slot of the mesh.
    first, count : int
        Rows of the instance table.
    holdout : bool
        A holdout: transparent in the picture, and hides what is behind it.
    shadow : bool
        It hides light.
    """

    mesh: int
    materials: tuple[int, ...]
    first: int
    count: int
    holdout: bool = False
    shadow: bool = True


@dataclass(frozen=True)
class Light:
    """A light.

    Parameters
    ----------
    kind : {'SUN', 'POINT', 'SPOT', 'AREA'}
    position : tuple of 3 float
        In world space; unused for the sun.
    direction : tuple of 3 float
        The way light travels along the axis, unit length, in world space; unused for a point.
    radiance : tuple of 3 float
        Sun: irradiance on a surface facing it, W/m^2. Point and spot: radiant intensity, W/sr.
        Area: radiance, W/(sr m^2).
    radius : float
        Soft size, in m; for a sun the sine of its disk's half angle.
    soft_falloff : bool
        A disk that always faces the shaded point, instead of a sphere.
    diffuse_factor, specular_factor : float
    cone : tuple of 2 float
        Spot: cosine of the half angle, and one over the width of its edge in cosines. Area: tangent
        of half the spread and the factor that keeps its power; 0 and 0 for all directions.
    axes : tuple of 3 tuples
        Rows that turn world directions away from the light into its own, x and y across, z along
        the beam; for a spot scaled as the cone is.
    half_size : tuple of 2 float
        Of an area light's rectangle, in m.
    highlights : bool
        False: what surfaces reflect of it is never splatted, however bright it is.
    shadow : bool
        What lies in its way hides it.
    """

    kind: str
    position: tuple[float, float, float]
    direction: tuple[float, float, float]
    radiance: tuple[float, float, float]
    radius: float = 0.0
    soft_falloff: bool = True
    diffuse_factor: float = 1.0
    specular_factor: float = 1.0
    cone: tuple[float, float] = (0.0, 0.0)
    axes: tuple[tuple[float, float, float], ...] = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
    half_size: tuple[float, float] = (0.0, 0.0)
    highlights: bool = True
    shadow: bool = True


@dataclass(frozen=True)
class World:
    """The world background: a constant colour, or an equirectangular image times a colour.

    Parameters
    ----------
    color : tuple of 3 float
        Scene linear; multiplies the image.
    image : int
        `ImageSnapshot.uid`, 0 for none.
    rotation : tuple of 3 tuples of 3 float
        Rows of the matrix that turns a world direction into the image's.
    amplification : float
        *Amplify Whites*: white of the image becomes 1 + this; see `sampling.highlights.amplify`.
    luminance : tuple of 3 float
        Weights of the channels in the luminance of a texel.
    graph : SurfaceGraph or None
        Nodes that compute the background from one or several images, of which `image` is one.
        None: the image is used as it is.
    lighting : World or None
        What surfaces are lit by and mirror where that is another world than the camera sees.
    """

    color: tuple[float, float, float] = (0.0, 0.0, 0.0)
    image: int = 0
    rotation: tuple[tuple[float, float, float], ...] = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
    amplification: float = 0.0
    luminance: tuple[float, float, float] = REC709_LUMINANCE
    graph: SurfaceGraph | None = None
    lighting: "World | None" = None


@dataclass(frozen=True, eq=False)
class SceneContent:
    """What is in front of the camera: meshes, instances, materials, images, lights and world.

    An unchanged scene keeps the very same object, also while the camera moves.

    Parameters
    ----------
    meshes, images, materials : dict of int to MeshSnapshot, ImageSnapshot, MaterialSnapshot
        By uid.
    instances : InstanceTable
    groups : tuple of InstanceGroup
    lights : tuple of Light
    world : World
    report : tuple of str
        Warnings: what cannot be drawn and what is drawn instead, one line each.
    unseen : SceneContent or None
        Meshes that the camera does not see, but that hide light.
    """

    meshes: dict[int, MeshSnapshot]
    images: dict[int, ImageSnapshot]
    materials: dict[int, MaterialSnapshot]
    instances: InstanceTable
    groups: tuple[InstanceGroup, ...]
    lights: tuple[Light, ...] = ()
    world: World = field(default_factory=World)
    report: tuple[str, ...] = ()
    unseen: "SceneContent | None" = None

    @cached_property
    def boxes(self):
        """The `InstanceBoxes` of the rows of the instance table."""
        world = self.instances.world
        return instance_boxes(world, self.groups, lambda uid: self.meshes[uid].bounds)

    @cached_property
    def group_of(self):
        """Which group each row of the instance table belongs to, shape (I,)."""
        found = np.zeros(len(self.instances.world), np.int64)
        for number, group in enumerate(self.groups):
            found[group.first : group.first + group.count] = number
        return found
