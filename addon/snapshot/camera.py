"""The camera of one frame as frozen values: view, projection, lens, bokeh settings."""

from dataclasses import dataclass, field

import numpy as np

from ..lens_bokeh.look.appearance import Appearance
from ..lens_bokeh.tables.artist_lens import ArtistLens
from ..optics.prescription import Prescription
from ..sampling.chromatic import ChromaticAberration
from ..sampling.highlights import WHITE
from ..sampling.thin_lens import ThinLens

# Relative difference of f-numbers below which they count as the same.
_SAME_F_NUMBER = 0.005


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
    exposure : {'EVEN', 'LENS'}
        Whether the picture keeps its brightness, or loses the light that the lens takes away.
    """

    id: str
    label: str | None
    f_number: float
    prescription: Prescription
    exposure: str = "EVEN"

    @property
    def shapes_bokeh(self):
        """Whether bokeh discs can be traced through it; else they are those of a thin lens."""
        return self.prescription.configuration(self.label).of_revolution

    @property
    def closing(self):
        """F-number over that of the lens wide open."""
        return max(self.f_number / self.prescription.configuration(self.label).f_number, 1.0)

    def limits(self, f_number):
        """Whether `f_number` asks for a wider opening than the lens has (`self.f_number`)."""
        return f_number < self.f_number * (1.0 - _SAME_F_NUMBER)


@dataclass(frozen=True)
class BokehSettings:
    """Bokeh settings: search, merging, visibility and look of highlights (methods 9 to 13).

    Parameters
    ----------
    threshold : float
        Radiance above which light counts as a highlight, of the largest channel.
    highlights : {'AUTO', 'THRESHOLD'}
        AUTO: thresholds are found from the picture instead: see `sampling.highlights`.
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
    vignetting : {'NONE', 'ANALYTIC', 'LENS'}
        Cat's eyes: none, by the appearance's rims, or by the real lens' own pupil.
    profile_strength : float
        0: even discs; 1: the intensity of the traced lens.
    debug_view : {'NONE', 'SOURCES', 'CLUSTERS', 'VISIBILITY'}
        Which marks the picture shows: sources before merging, after merging, or their fates
        (culled, masked, ...).
    """

    threshold: float = 1.0
    highlights: str = "THRESHOLD"
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
    vignetting: str = "NONE"
    profile_strength: float = 1.0
    debug_view: str = "NONE"

    @property
    def automatic(self):
        """Whether thresholds are found from the picture."""
        return self.highlights == "AUTO"

    @property
    def least_threshold(self):
        """Radiance up to which no light is a highlight."""
        return WHITE if self.automatic else self.threshold


@dataclass(frozen=True, eq=False)
class Camera:
    """The camera: view, projection, thin and real lens, chromatic aberration, bokeh.

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
    distortion : tuple of float
        K1, K2, ... of the division model (`optics.distortion`), in units of the distance from the
        optical axis to the picture's outermost corner; empty: none.
    breathing : float
        How much larger the picture is drawn than with the focus at infinity; `projection` has it.
    artist : ArtistLens or None
        Aberrations of a camera without a real lens; None: none.
    f_number : float
        Of the thin lens, for these.
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
    distortion: tuple[float, ...] = ()
    breathing: float = 1.0
    artist: ArtistLens | None = None
    f_number: float = 0.0
    field_radius: float | None = None
