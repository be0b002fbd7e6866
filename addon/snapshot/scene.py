"""The scene of one frame as frozen values: no Blender object survives in here.

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

from ..lens_bokeh.look.appearance import Appearance
from ..optics.prescription import Prescription
from ..sampling.chromatic import ChromaticAberration
from ..sampling.thin_lens import ThinLens
from .surface_graph import REC709_LUMINANCE, SurfaceGraph

# Relative difference of f-numbers below which they count as the same.
_SAME_F_NUMBER = 0.005

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
        float32 of shape (V, k): ``"normal"`` (k = 3), ``"uv:NAME"`` (2), ``"color:NAME"`` (4, scene
        linear). An empty NAME is the active one.
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
    """

    world: np.ndarray
    cryptomatte_id: np.ndarray
    previous_world: np.ndarray | None = None
    next_world: np.ndarray | None = None
    names: tuple[str, ...] = ()


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
    """

    mesh: int
    materials: tuple[int, ...]
    first: int
    count: int
    holdout: bool = False


@dataclass(frozen=True)
class Light:
    """A light without shadows.

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
    """

    color: tuple[float, float, float] = (0.0, 0.0, 0.0)
    image: int = 0
    rotation: tuple[tuple[float, float, float], ...] = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
    amplification: float = 0.0
    luminance: tuple[float, float, float] = REC709_LUMINANCE
    graph: SurfaceGraph | None = None


@dataclass(frozen=True)
class LensSettings:
    """A real lens as a camera uses it.

    Parameters
    ----------
    id : str
        Of the library.
    label : str or None
        Of the zoom position; None for a lens that has none.
    f_number : float
        In force: what the camera asks for, but no wider than the lens opens.
    prescription : Prescription
    """

    id: str
    label: str | None
    f_number: float
    prescription: Prescription

    @property
    def shapes_bokeh(self):
        """Whether bokeh discs can be traced through it; else they are those of a thin lens."""
        return self.prescription.configuration(self.label).of_revolution

    def limits(self, f_number):
        """Whether `f_number` asks for a wider opening than the lens has (`self.f_number`)."""
        return f_number < self.f_number * (1.0 - _SAME_F_NUMBER)


@dataclass(frozen=True)
class BokehSettings:
    """How highlights are drawn apart from the rest of the picture (methods 9 to 13).

    Parameters
    ----------
    threshold : float
        Radiance above which light counts as a highlight, of the largest channel.
    gain : float
        Multiplies the highlights; 1 keeps the picture's energy.
    model : {'AUTO', 'POINT', 'CLUSTERED'}
        AUTO: a source for every pixel of a highlight, merged only where there are very many;
        POINT: a source for every pixel; CLUSTERED: similar highlights are merged.
    cluster_levels : int
        How often neighbours are merged at most; each level halves the resolution.
    similarity : float
        How different merged highlights may be; 1 is what the scene's size suggests.
    global_merge : bool
        Similar clusters are merged wherever they lie.
    visibility : {'AUTO', 'RASTER', 'WARP', 'SPLAT'}
        How occlusion of a highlight over the lens is found: RASTER draws the scene from the
        highlight, WARP casts rays through depth-peeled layers, SPLAT does so for each pixel of the
        disc.
    layers : int
        Surfaces behind one another that are searched for highlights.
    overscan : float
        How far outside the frame highlights are searched at most, as a share of its longer side.
    lens_views : int
        Number of places on the lens from which mirroring surfaces are searched for highlights, as
        their reflections depend on the place. All other surfaces are searched from one.
    world : bool
        Highlights of the world's image are found, too.
    appearance : Appearance
        Shape of the discs: iris, grain, dust, diffraction, rings, rims.
    distortion : float
        K of the division model, in units of the distance from the picture's middle to its corner;
        negative is a barrel.
    vignetting : {'NONE', 'ANALYTIC', 'LENS'}
        Cat's eyes: none, by the appearance's rims, or by the real lens' own pupil.
    profile_strength : float
        0: even discs; 1: the intensity of the traced lens.
    debug_view : {'NONE', 'SOURCES', 'CLUSTERS', 'VISIBILITY'}
        Which marks the picture shows: sources before merging, after merging, or their fates
        (culled, masked, ...).
    """

    threshold: float = 1.0
    gain: float = 1.0
    model: str = "AUTO"
    cluster_levels: int = 4
    similarity: float = 1.0
    global_merge: bool = False
    visibility: str = "AUTO"
    layers: int = 4
    overscan: float = 0.25
    lens_views: int = 4
    world: bool = True
    appearance: Appearance = field(default_factory=Appearance)
    distortion: float = 0.0
    vignetting: str = "NONE"
    profile_strength: float = 1.0
    debug_view: str = "NONE"


@dataclass(frozen=True, eq=False)
class Camera:
    """Where the picture is taken from.

    Parameters
    ----------
    view : ndarray of shape (4, 4)
        World to camera space (x right, y up, looking along -z), rigid, float64.
    projection : ndarray of shape (4, 4)
        Camera space to clip space of the whole picture, OpenGL convention.
    lens : ThinLens or None
        None is a pinhole.
    orthographic : bool
    previous, next : tuple of two ndarray of shape (4, 4) or None
        View and projection in the neighbouring frames, when motion was asked for.
    real_lens : LensSettings or None
        None: the camera names no lens that can be used.
    bokeh : BokehSettings or None
        None: highlights are sampled like all other light.
    report : tuple of str
        Warnings: settings of the camera that cannot be met, one line each.
    chromatic : ChromaticAberration or None
        None: no chromatic aberration.
    field_radius : float or None
        Distance of the outermost corner of the camera's own picture from the optical axis: as a
        tangent, for a parallel projection in m. None: that of `projection`.
    """

    view: np.ndarray
    projection: np.ndarray
    lens: ThinLens | None = None
    orthographic: bool = False
    previous: tuple[np.ndarray, np.ndarray] | None = None
    next: tuple[np.ndarray, np.ndarray] | None = None
    real_lens: LensSettings | None = None
    bokeh: BokehSettings | None = None
    report: tuple[str, ...] = ()
    chromatic: ChromaticAberration | None = None
    field_radius: float | None = None


@dataclass(frozen=True)
class Film:
    """The raster.

    Parameters
    ----------
    width, height : int
        Of the whole picture, in pixels.
    region : tuple of 4 int
        x, y, width, height of the part that is rendered; y from the bottom.
    transparent : bool
        The world is left out of the picture.
    filter_kind : {'BLACKMAN_HARRIS', 'BOX'}
    filter_size_px : float
        As Blender's filter size.
    """

    width: int
    height: int
    region: tuple[int, int, int, int]
    transparent: bool = False
    filter_kind: str = "BLACKMAN_HARRIS"
    filter_size_px: float = 1.5


@dataclass(frozen=True)
class Sampling:
    """How the frame is sampled.

    Parameters
    ----------
    method : {'REFERENCE', 'ADAPTIVE'}
    lens_samples : int
    seed : int
    target_error : float or None
        Noise threshold of the adaptive method, as 1 - SSIM: samples are drawn until the error is
        below it, and `subsamples`, `reuse_grid` and `level_bias` are chosen from it. None: a fixed
        number of samples, and those settings as they are.
    least_samples, most_samples : int
        Bounds of the lens samples with a target error.
    time_limit : float or None
        Seconds of drawing after which sampling stops, whatever the method.
    subsamples : int
        Places on the lens that each lens sample stands for besides its own, on the average.
    reuse_grid : int
        Cells along a pixel in which lens samples share a drawing; 0 shares none.
    uses_levels : bool
        Blurred objects are drawn at a lower level of detail.
    level_bias : float
        Subtracted from the level of detail.
    least_triangles : int
        No level of detail has fewer.
    progressive : bool
        The picture may be looked at before all samples are drawn.
    reference_bokeh : bool
        The reference method, too, splats highlights as bokeh, instead of sampling them.
    """

    method: str = "REFERENCE"
    lens_samples: int = 128
    seed: int = 0
    target_error: float | None = None
    least_samples: int = 1
    most_samples: int = 4096
    time_limit: float | None = None
    subsamples: int = 0
    reuse_grid: int = 2
    uses_levels: bool = True
    level_bias: float = 0.0
    least_triangles: int = 256
    progressive: bool = False
    reference_bokeh: bool = False


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
    """

    meshes: dict[int, MeshSnapshot]
    images: dict[int, ImageSnapshot]
    materials: dict[int, MaterialSnapshot]
    instances: InstanceTable
    groups: tuple[InstanceGroup, ...]
    lights: tuple[Light, ...] = ()
    world: World = field(default_factory=World)
    report: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class SceneSnapshot:
    """Everything a frame needs.

    Parameters
    ----------
    content : SceneContent
    camera : Camera
    film : Film
    sampling : Sampling
    passes : tuple of str
        Names as in Blender: ``"Combined"``, ``"Depth"``, ...
    layer_name : str
    alpha_threshold : float
        Opacity below which a surface is left out of Depth, Normal and their like.
    """

    content: SceneContent
    camera: Camera
    film: Film
    sampling: Sampling
    passes: tuple[str, ...] = ("Combined",)
    layer_name: str = ""
    alpha_threshold: float = 0.5
