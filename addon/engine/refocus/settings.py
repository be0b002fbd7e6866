"""How a captured picture is seen through the lens: values, without Blender."""

from dataclasses import dataclass, replace

from ...lens_bokeh.openings.shapes import stopped_down
from ...lens_bokeh.tables.artist_lens import ArtistLens
from ...sampling.chromatic import ChromaticAberration
from ...sampling.iris import Iris
from ...sampling.thin_lens import ThinLens, aperture_radius
from ...settings.refocus_settings import REFOCUS
from ...settings.setting import settings_of
from ...snapshot.camera import BokehSettings, LensSettings


@dataclass(frozen=True)
class RefocusSettings:
    """The lens that a captured picture is seen through, as a camera has it.

    Parameters
    ----------
    focus_distance : float or None
        Along the optical axis, m; None: as captured.
    f_stop : float or None
        None: as captured.
    iris : Iris or None
        The opening, of lens samples and of the discs of highlights; None: round or of straight
        blades, as captured.
    real_lens : LensSettings or None
        A real lens, which opens no wider than it can and shapes the discs; None: a thin lens.
    bokeh : BokehSettings or None
        None: highlights are sampled like all other light.
    chromatic : ChromaticAberration or None
        None: no chromatic aberration.
    distortion : tuple of float
        As of `snapshot.camera.Camera`.
    artist : ArtistLens or None
        Aberrations without a real lens.
    samples : int
        Lens samples.
    seed : int
        Of their pattern.
    """

    focus_distance: float | None = None
    f_stop: float | None = None
    iris: Iris | None = None
    real_lens: LensSettings | None = None
    bokeh: BokehSettings | None = None
    chromatic: ChromaticAberration | None = None
    distortion: tuple[float, ...] = ()
    samples: int = settings_of(REFOCUS)["samples"].default
    seed: int = 0
    artist: ArtistLens | None = None


def f_stop_of(stack, settings):
    """Return the f-number that a captured picture is seen with; a lens opens as far as it can."""
    f_stop = stack.camera.f_stop if settings.f_stop is None else settings.f_stop
    if settings.real_lens is None:
        return f_stop
    lens = settings.real_lens
    return max(f_stop, lens.prescription.configuration(lens.label).f_number)


def real_lens_of(stack, settings):
    """Return the real lens that a captured picture is seen through, at its f-number, or None."""
    lens = settings.real_lens
    return lens and replace(lens, f_number=f_stop_of(stack, settings))


def bokeh_of(stack, settings):
    """Return the `BokehSettings` of a captured picture, at the f-number that it is seen with."""
    bokeh, lens = settings.bokeh, real_lens_of(stack, settings)
    if bokeh is None:
        return None
    iris = stopped_down(bokeh.appearance.iris, lens and lens.closing)
    return replace(bokeh, appearance=replace(bokeh.appearance, iris=iris))


def lens_of(stack, settings):
    """Return the thin lens that a captured picture is seen through.

    Parameters
    ----------
    stack : LayerStack
    settings : RefocusSettings

    Returns
    -------
    ThinLens

    Raises
    ------
    FocusError
        If the focus distance or the f-number cannot form a picture.
    """
    camera = stack.camera
    f_stop = f_stop_of(stack, settings)
    # Also refuses an f-number that is none.
    radius = aperture_radius(camera.focal_length_mm / 1000.0, f_stop)
    if camera.aperture_radius is not None:
        radius = camera.aperture_radius * camera.f_stop / f_stop
    iris = settings.iris or Iris(camera.blades, camera.blade_rotation, camera.aperture_ratio)
    lens = real_lens_of(stack, settings)
    if iris.opening is not None:
        iris = replace(iris, opening=stopped_down(iris.opening, lens and lens.closing))
    focus = settings.focus_distance
    return ThinLens(radius, camera.focus_distance if focus is None else focus, iris)
