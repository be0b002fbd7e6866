"""Thumbnails of a lens: cross-section and bokeh."""

import math

import numpy as np

from ..errors import RenderCancelledError
from ..lens_bokeh.look.deposit import pattern
from ..lens_bokeh.tables.mapping import pattern_row
from ..lens_bokeh.tables.profile import make_profile
from ..lens_bokeh.tables.pupil_beam import beam_from_infinity, beam_from_point
from ..lens_io.profile_cache import content_hash, pupil_tables
from ..optics.focus import focused
from ..optics.glass import REFERENCE_WAVELENGTH_NM
from ..optics.paraxial import first_order, image_distance
from ..sampling.spectrum import rgb_weights
from .bokeh_plots import disk_picture, displayed, held_radius, traced_disk
from .cross_section import ON_BLACK, draw_cross_section
from .kept_pictures import kept_picture, state_name

# Pixels on a side.
THUMBNAIL_SIZE = 256
SHEET_TILE = 64
# Versions of the drawings, part of the names of cached pictures.
_THUMBNAIL, _SHEET = "thumb-1", "sheet-1"
_BACKGROUND = "#1b1d20"
# Focus in focal lengths (2 m at 50 mm), and lights in front of it, behind it and far away.
_FOCUS = 40.0
_LIGHTS = (0.5, 2.0, math.inf)
# Of a sheet: focus distances, and shares of the half field.
SHEET_LIGHTS = (0.5, 0.75, 2.0, math.inf)
SHEET_FIELDS = (0.0, 0.35, 0.7, 1.0)
# The colours in which a lens is shown away from its axis; the first is the one for which rims are
# traced.
_WAVELENGTHS_NM = (REFERENCE_WAVELENGTH_NM, 460.0, 530.0, 620.0)
# Share of the energy inside a picture: nearly all, as a faint halo reaches far.
_HELD = 0.98


def thumbnail(prescription, progress=None, cancelled=None, folder=None):
    """Draw the cross-section of a lens with fans of rays, and its bokeh at three depths below.

    The lights stand in front of, behind and far behind the focus, on the axis.

    Parameters
    ----------
    prescription : Prescription
    progress : callable or None
        Told the share done, 0 to 1.
    cancelled : callable or None
        Asked between steps; true ends the work.
    folder : Path or None
        Where pictures are kept; None: `profile_folder`.

    Returns
    -------
    ndarray of shape (THUMBNAIL_SIZE, THUMBNAIL_SIZE, 4)
        float32, display colours, first row at the top.

    Raises
    ------
    RenderCancelledError
        If it was cancelled.
    PrescriptionError
        If the lens forms no image.
    """
    return kept_picture(
        f"{_THUMBNAIL}-{content_hash(prescription)[:32]}",
        (THUMBNAIL_SIZE, THUMBNAIL_SIZE, 4),
        folder,
        lambda: _draw_thumbnail(prescription, watched(progress, cancelled)),
    )


def bokeh_sheet(prescription, label, f_number, iris, progress=None, cancelled=None, folder=None):
    """Draw what points of light look like: depths side by side, axis to corner downwards.

    Brightness is relative to the axis: what the lens vignettes is darker. The corner of the
    picture is up.

    Parameters
    ----------
    prescription : Prescription
    label : str or None
        Zoom position.
    f_number : float
    iris : BladedIris or PictureIris
    progress : callable or None
        Told the share done, 0 to 1.
    cancelled : callable or None
        Asked between steps; true ends the work.
    folder : Path or None
        Where pictures are kept; None: `profile_folder`.

    Returns
    -------
    ndarray of shape (F SHEET_TILE, L SHEET_TILE, 4)
        Rows of `SHEET_FIELDS`, columns of `SHEET_LIGHTS`;
        float32, display colours, first row at the top.

    Raises
    ------
    RenderCancelledError
        If it was cancelled.
    PrescriptionError
        If the lens forms no image, or is not one of revolution.
    """
    given = prescription, label, f_number, iris

    def draw():
        picture = _draw_sheet(*given, watched(progress, cancelled), cancelled)
        return np.round(255.0 * picture).astype(np.uint8)

    shape = len(SHEET_FIELDS) * SHEET_TILE, len(SHEET_LIGHTS) * SHEET_TILE, 4
    return kept_picture(state_name(_SHEET, given), shape, folder, draw)


def _draw_sheet(prescription, label, f_number, iris, step, cancelled):
    tables = pupil_tables(
        prescription,
        label,
        wavelengths_nm=_WAVELENGTHS_NM,
        progress=lambda share: step(0.7 * share),
        cancelled=cancelled,
    )
    configuration = prescription.configuration(label)
    values = first_order(configuration)
    focus = _FOCUS * values.efl
    profile = make_profile(configuration, chromatic=False)
    plane = configuration.vertices[-1] + image_distance(configuration, focus - values.h)
    shift = plane - configuration.sensor
    shares = rgb_weights(np.array(_WAVELENGTHS_NM))
    columns = []
    for column, light in enumerate(SHEET_LIGHTS):
        row = pattern_row(profile, light * focus, focus, f_number, 256)
        radius = held_radius(row, _HELD)
        on_axis = None
        tiles = []
        for order, field in enumerate(SHEET_FIELDS):
            done = (column + order / len(SHEET_FIELDS)) / len(SHEET_LIGHTS)
            step(0.7 + 0.3 * done)
            angle = math.radians(field * configuration.half_field_deg)
            energy = sum(
                _energy(tables, angle, light * focus, values.h, (f_number, iris, shift, radius), i)
                * share
                for i, share in enumerate(shares)
            )
            on_axis = energy.sum(axis=(0, 1)) if on_axis is None else on_axis
            # In units of an even disk of this radius.
            scale = (SHEET_TILE / (2.0 * _MARGIN)) ** 2
            tiles.append(displayed(energy / np.maximum(on_axis, 1e-30) * scale)[::-1])
        columns.append(np.concatenate(tiles))
    picture = np.concatenate(columns, axis=1)
    return np.concatenate([picture, np.ones((*picture.shape[:2], 1))], axis=-1)


# Half the width of a tile, in radii of the axial disk.
_MARGIN = 1.6


def _energy(tables, angle, distance, principal, setting, wavelength):
    f_number, iris, shift, radius = setting
    if math.isinf(distance):
        beam = beam_from_infinity(tables, angle, f_number, wavelength)
    else:
        # Depths are told from the principal plane, the tables' from surface 1.
        depth = distance - principal
        if angle > math.radians(60.0):
            # Nobody places lights of a fisheye in a plane across its axis.
            depth *= math.cos(angle)
        beam = beam_from_point(tables, depth * math.tan(angle), depth, f_number, wavelength)
    # All colours around the chief ray of the reference, so that lateral colour shows.
    return pattern(beam, shift, SHEET_TILE, _MARGIN * radius, iris=iris)[..., None]


def _draw_thumbnail(prescription, step):
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    step(0.1)
    configuration = prescription.configuration()
    inches = THUMBNAIL_SIZE / 100.0
    figure = Figure(figsize=(inches, inches), dpi=100, facecolor=_BACKGROUND)
    canvas = FigureCanvasAgg(figure)
    axes = figure.add_axes((0.02, 0.36, 0.96, 0.62))
    axes.set_axis_off()
    draw_cross_section(
        axes,
        configuration,
        fields_deg=(0.0, 0.7 * configuration.half_field_deg),
        palette=ON_BLACK,
    )
    step(0.3)
    for column, disk in enumerate(_disks(configuration)):
        axes = figure.add_axes((0.02 + column * 0.325, 0.02, 0.31, 0.31))
        axes.set_axis_off()
        if disk is not None:
            axes.imshow(disk, interpolation="bilinear", origin="lower")
        step(0.4 + 0.2 * column)
    canvas.draw()
    return np.array(canvas.buffer_rgba())


def _disks(configuration):
    values = first_order(configuration)
    focus = _FOCUS * values.efl
    if not configuration.of_revolution:
        lens = focused(configuration, focus - values.h)
        for light in _LIGHTS:
            far = math.isinf(light)
            source = 0.0 if far else (0.0, 0.0, values.h - light * focus)
            disk = traced_disk(lens, source, _WAVELENGTHS_NM[1:])
            # Without colour, as the others.
            yield disk if disk is None else np.repeat(disk.mean(axis=-1, keepdims=True), 3, axis=-1)
        return
    profile = make_profile(configuration, chromatic=False)
    for light in _LIGHTS:
        row = pattern_row(profile, light * focus, focus, configuration.f_number, 256)
        yield disk_picture(row, 1.1 * held_radius(row, _HELD))


def watched(progress, cancelled):
    """Return a function that tells the share done, and ends the work where it was cancelled.

    Parameters
    ----------
    progress, cancelled : callable or None
        As for `thumbnail`.

    Returns
    -------
    callable
        Raises RenderCancelledError.
    """

    def step(share):
        if cancelled is not None and cancelled():
            raise RenderCancelledError("drawing a lens was stopped")
        if progress is not None:
            progress(share)

    return step
