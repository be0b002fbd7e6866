"""Tracing the pupil tables of a lens: fields over the angle, one grid of rays a field.

See `addon.lens_bokeh.tables.pupil_tables` for what the tables hold.
"""

import numpy as np

from ...errors import PrescriptionError, RenderCancelledError
from ...optics.glass import REFERENCE_WAVELENGTH_NM
from ...optics.rays.trace import RayStatus, trace
from .pupil_box import beam_rays, clearances, limiting_rims, passing_box
from .pupil_tables import CHANNELS, CURVES, MARGIN, ODD_IN_X, RIMS, PupilTables

_RIMS_APART = 3
GRID = 97
# Tables reach beyond the nominal field: near points and rims of the picture need it.
FIELD_MARGIN = 1.15
LARGEST_ANGLE = np.radians(89.0)
_BOX_ANGLES = 25
_BOX_TERMS = 5
_CURVE_STEPS = 129
FIELDS = 25
# Steps to the neighbours of a place: rows, columns.
_AROUND = np.array([(v, x) for v in (-1, 0, 1) for x in (-1, 0, 1) if (v, x) != (0, 0)]).T[
    ..., None
]


def build_pupil_tables(
    configuration,
    wavelengths_nm=(REFERENCE_WAVELENGTH_NM,),
    *,
    coating=None,
    grid=GRID,
    progress=None,
    cancelled=None,
):
    """Trace the tables of a lens.

    Parameters
    ----------
    configuration : Configuration
        At full opening; focused where it is to be used if a group of it moves for focusing.
    wavelengths_nm : sequence of float
        The first one is the reference: rims and stop are traced for it alone.
    coating : Coating or None
    grid : int
        Rays across the box, odd.
    progress : callable or None
        Called with the share done, 0 to 1.
    cancelled : callable or None
        Asked between fields; if true, the build ends.

    Returns
    -------
    PupilTables

    Raises
    ------
    RenderCancelledError
        If it was cancelled.
    PrescriptionError
        If the lens is not one of revolution, or no ray of the axial beam gets through.
    """
    if not configuration.of_revolution:
        raise PrescriptionError(
            "pupil tables are for lenses of revolution; this lens has a cylinder"
        )
    wavelength = wavelengths_nm[0]

    def report(share):
        if cancelled is not None and cancelled():
            raise RenderCancelledError("the pupil tables were cancelled")
        if progress is not None:
            progress(share)

    limit = min(np.radians(configuration.half_field_deg) * FIELD_MARGIN, LARGEST_ANGLE)
    curves, beams = _box_curves(configuration, limit, wavelength, lambda s: report(0.4 * s))
    rims = limiting_rims(configuration, beams[::3], wavelength, _RIMS_APART)
    tracer = _FieldTracer(configuration, limit / (_CURVE_STEPS - 1), curves, rims, coating)
    angles = np.linspace(0.0, limit, FIELDS)
    layers = []
    for done, angle in enumerate(angles):
        report(0.4 + 0.6 * done / FIELDS)
        layers.append([tracer.table(angle, grid, each) for each in wavelengths_nm])
    tables = np.array([layer[0] for layer in layers])
    chromatic = np.array([[one[..., :4] for one in layer[1:]] for layer in layers])
    chromatic = chromatic.reshape(FIELDS, len(wavelengths_nm) - 1, grid, grid, 4)
    chromatic = np.moveaxis(chromatic, 0, 1) - tables[..., :4]
    report(1.0)
    return PupilTables(
        curve_step=tracer.step,
        curves=tracer.curves,
        field_step=limit / (FIELDS - 1),
        tables=tables.astype(np.float32),
        chromatic=chromatic.astype(np.float32),
        wavelengths_nm=tuple(float(each) for each in wavelengths_nm),
        sensor=configuration.sensor,
        stop_radius=configuration.surfaces[configuration.stop - 1].semi_diameter,
        f_number=configuration.f_number,
        half_field_deg=configuration.half_field_deg,
    )


def _box_curves(configuration, limit, wavelength, report):
    """half_x, centre_v, half_v on the fine steps, shape (K, 3); angles and boxes found."""
    angles = np.linspace(0.0, limit, _BOX_ANGLES)
    found, boxes, beams = [], [], []
    for done, angle in enumerate(angles):
        report(done / len(angles))
        box = passing_box(configuration, angle, wavelength)
        if box is None:
            # Beyond the last field with light the box goes on as it went.
            break
        half_x, low, high = box
        found.append(angle)
        beams.append((angle, box))
        boxes.append((half_x, 0.5 * (low + high), 0.5 * (high - low)))
    if not boxes:
        raise PrescriptionError("no ray of the axial beam gets through the lens")
    found, boxes = np.array(found), np.array(boxes)
    if len(found) < len(angles):
        # The centre goes on as it went; the widths stay, so that they stay positive.
        back = max(len(found) - 3, 0)
        span = max(found[-1] - found[back], 1e-9)
        slope = (boxes[-1, 1] - boxes[back, 1]) / span
        further = np.repeat(boxes[-1:], len(angles) - len(found), axis=0)
        further[:, 1] += slope * (angles[len(found) :] - found[-1])
        boxes = np.concatenate([boxes, further])
    # Rims that begin to cut make kinks, which would go into all tables: the curves are smooth
    # fits, even or odd in the angle, and wide enough for every box.
    t, fine = angles / limit, np.linspace(0.0, 1.0, _CURVE_STEPS)
    curves = np.empty((_CURVE_STEPS, 3))
    fitted = np.empty_like(boxes)
    for column, odd in enumerate((0, 1, 0)):
        powers = 2 * np.arange(_BOX_TERMS) + odd
        terms, _, _, _ = np.linalg.lstsq(t[:, None] ** powers, boxes[:, column], rcond=None)
        curves[:, column] = fine[:, None] ** powers @ terms
        fitted[:, column] = t[:, None] ** powers @ terms
    for column in (0, 2):
        least = 0.25 * boxes[:, column].min()
        curves[:, column] = np.maximum(curves[:, column], least)
        fitted[:, column] = np.maximum(fitted[:, column], least)
    curves[:, 0] *= max(1.0, (boxes[:, 0] / fitted[:, 0]).max())
    reach = np.abs(boxes[:, 1] - fitted[:, 1]) + boxes[:, 2]
    curves[:, 2] *= max(1.0, (reach / fitted[:, 2]).max())
    return curves, beams


class _FieldTracer:
    """Traces tables of single fields, given the curves of the box."""

    def __init__(self, configuration, step, boxes, rims, coating):
        self.configuration = configuration
        self.step = step
        self.rims = rims
        self.coating = coating
        self.curves = np.zeros((len(boxes), len(CURVES)))
        self.curves[:, 1:] = boxes
        self.curves[:, 0] = self._image_heights()
        self.plain = PupilTables(
            step, self.curves, 0.0, np.zeros(0), np.zeros(0), (), 0.0, 0.0, 0.0, 0.0
        )

    def _image_heights(self):
        heights = np.full(len(self.curves), np.nan)
        for i, (_, _, centre, _) in enumerate(self.curves):
            ray = beam_rays(i * self.step, np.zeros(1), np.array([centre]))
            traced = trace(self.configuration, ray, REFERENCE_WAVELENGTH_NM, clip=False)
            if traced.reached[0]:
                heights[i] = traced.at_plane(self.configuration.sensor)[0, 1]
        good = np.flatnonzero(np.isfinite(heights))
        if len(good) < 2:
            return np.zeros(len(heights))
        last = good[-1]
        heights[:last] = np.interp(np.arange(last), good, heights[good])
        slope = heights[last] - heights[last - 1]
        heights[last:] = heights[last] + slope * np.arange(len(heights) - last)
        return heights

    def table(self, angle, grid, wavelength):
        """Trace the table of a field, shape (grid, grid, 11)."""
        configuration = self.configuration
        height, half_x, centre, half_v = self.plain.curves_at(angle)
        axis = np.linspace(-1.0 - MARGIN, 1.0 + MARGIN, grid)
        # Mirror symmetry: half the columns are traced.
        half = axis[grid // 2 :]
        x, v = (a.ravel() for a in np.meshgrid(half * half_x, axis * half_v + centre))
        traced = trace(
            configuration, beam_rays(angle, x, v), wavelength, clip=False, record=True,
            transmission=True, coating=self.coating,
        )  # fmt: skip
        known = traced.reached & (traced.status < RayStatus.MISSED) & (traced.directions[:, 2] > 0)
        inside, stop = clearances(configuration, traced.hits, self.rims)
        values = np.zeros((len(x), len(CHANNELS)))
        values[:, :2] = traced.at_plane(configuration.sensor)
        values[:, 1] -= height
        values[:, 2:4] = (
            traced.directions[:, :2] / np.where(known, traced.directions[:, 2], 1.0)[:, None]
        )
        values[:, 4:6] = stop
        values[:, RIMS] = 1.0
        values[:, RIMS.stop - inside.shape[1] : RIMS.stop] = inside
        values[:, 10] = traced.transmission
        shape = (grid, len(half))
        values = _continued(values.reshape(*shape, -1), known.reshape(shape))
        mirrored = values[:, :0:-1] * ODD_IN_X
        return np.concatenate([mirrored, values], axis=1)


def _continued(values, known):
    """Fill places without a ray from their neighbours, linearly, and mark them as blocked."""
    if known.all():
        return values
    if not known.any():
        values = np.zeros_like(values)
        values[..., RIMS] = -1.0
        return values
    missing = ~known
    # A margin of two, as far as a ring looks.
    values = np.pad(np.where(known[..., None], values, 0.0), ((2, 2), (2, 2), (0, 0)))
    reliable = np.pad(known, 2)
    for ring in range(max(known.shape)):
        open_places = 2 + np.argwhere(~reliable[2:-2, 2:-2]).T
        if not open_places.size:
            break
        # Row and column, neighbour, place.
        near = open_places[:, None] + _AROUND
        both, guess = reliable[*near], values[*near]
        # Three rings follow the slope; farther out that would run away.
        if ring < 3:
            both = both & reliable[*(near + _AROUND)]
            guess = 2.0 * guess - values[*(near + _AROUND)]
        count = both.sum(axis=0)
        new = count > 0
        if ring >= 3 and not new.any():
            break
        total = np.where(both[..., None], guess, 0.0).sum(axis=0)
        filled = tuple(open_places[:, new])
        values[filled] = total[new] / count[new][:, None]
        reliable[filled] = True
    values = values[2:-2, 2:-2].copy()
    # Where total reflection ends the beam inside all rims, the rim is halfway to the lost ray.
    lost = missing & (values[..., RIMS].min(axis=-1) > 0.0)
    values[lost, 9] = -np.abs(values[lost, 9])
    # No light where no ray is known, however the slopes went on.
    values[..., 9] = np.where(missing, np.minimum(values[..., 9], -1e-3), values[..., 9])
    values[missing, 10] = np.clip(values[missing, 10], 0.0, 1.0)
    return values
