"""Contrast of fine lines in the picture of a lens: its modulation transfer at infinity focus.

Real rays of three colours are traced to the plane in which the middle of the picture has the most
contrast. There, with w the shares of light and x where it lands, lines of frequency f keep

    |sum w exp(2 pi i f x)| / sum w

of their contrast; diffraction at the f-number takes its share by the transfer of an ideal round
opening. What both do together is taken as their product, which is good to some per cent.

References: Smith, Modern Optical Engineering, 3rd ed. 2000, sections 11.8 (geometric modulation
transfer) and 11.9 (diffraction).
"""

import numpy as np

from .pupil import pupil_rays
from .trace import trace

# Fraunhofer's C, d and F, and how much of what is seen is near them.
COLORS_NM, _SHARES = (656.2725, 587.5618, 486.1327), (0.25, 0.5, 0.25)
_REFERENCE = 1
_GRID = 61
# Search for the sharpest plane: first steps in blurs of a line and their number at most; then the
# planes of each refinement, and how many there are.
_STEP, _MOST_PLANES, _PLANES, _SEARCHES = 0.3, 300, 11, 2
# Least slope of a ray that has a waist.
_LEAST_SLOPE = 1.0e-9


def contrast(configuration, fields_deg, lines_per_mm, f_number=None):
    """Contrast that lines of equal light and dark keep, over the field.

    Parameters
    ----------
    configuration : Configuration
        Of revolution.
    fields_deg : sequence of F float
    lines_per_mm : float
        Pairs of lines.
    f_number : float or None
        The lens is stopped down to it; None: wide open.

    Returns
    -------
    ndarray of shape (F, 2)
        0 to 1 for sagittal lines (that point away from the middle) and tangential ones; nan where
        nothing gets through.

    Raises
    ------
    PrescriptionError
        If a field angle is not below 90 degrees, or the lens forms no image.
    """
    f_number = max(f_number or 0.0, configuration.f_number)
    plane = _sharpest(configuration, lines_per_mm, f_number)
    diffracted = _diffracted(lines_per_mm, f_number)
    found = []
    for field in fields_deg:
        rays = _rays(configuration, field, f_number)
        found.append(_kept(rays, plane, lines_per_mm) * diffracted)
    return np.array(found).reshape(-1, 2)


def _rays(configuration, field_deg, f_number):
    """Return where rays of each colour are and go, and their shares of the light."""
    bundle = pupil_rays(configuration, field_deg, _GRID)
    stop = configuration.stop
    at_stop = trace(configuration, bundle.rays, COLORS_NM[_REFERENCE], last=stop)
    opening = configuration.surfaces[stop - 1].semi_diameter * configuration.f_number / f_number
    inside = np.hypot(at_stop.points[:, 0], at_stop.points[:, 1]) <= opening
    points, slopes, shares = [], [], []
    for color, part in zip(COLORS_NM, _SHARES, strict=True):
        traced = trace(configuration, bundle.rays, color)
        passed = traced.passed & inside
        direction = traced.directions[passed]
        slope = direction[:, :2] / direction[:, 2:]
        points.append(traced.points[passed, :2] - traced.points[passed, 2:] * slope)
        slopes.append(slope)
        weight = bundle.weights[passed]
        shares.append(part * weight / max(float(weight.sum()), 1e-30))
    return np.concatenate(points), np.concatenate(slopes), np.concatenate(shares)


def _kept(rays, plane, frequency):
    points, slopes, shares = rays
    if not len(points):
        return np.full(2, np.nan)
    places = points + plane * slopes
    # Around their middle: the phase of a far point has few digits left.
    waves = np.exp(2j * np.pi * frequency * (places - places.mean(axis=0)))
    return np.abs(shares @ waves) / shares.sum()


def _sharpest(configuration, frequency, f_number):
    points, slopes, _ = rays = _rays(configuration, 0.0, f_number)
    steep = np.sum(slopes**2, axis=1)
    leans = steep > _LEAST_SLOPE**2
    if not leans.any():
        return configuration.sensor
    # Where each ray is nearest to the axis: the sharpest plane lies among these.
    waists = -np.sum(points * slopes, axis=1)[leans] / steep[leans]
    # A shift by N / f blurs by about the width of a line.
    step = _STEP * f_number / frequency
    count = int(np.clip((waists.max() - waists.min()) / step, 2, _MOST_PLANES))
    planes = np.linspace(waists.min(), waists.max(), count)
    for _ in range(1 + _SEARCHES):
        best = planes[int(np.argmax([_kept(rays, plane, frequency)[1] for plane in planes]))]
        step = planes[1] - planes[0]
        planes = best + np.linspace(-step, step, _PLANES)
    return best


def _diffracted(frequency, f_number):
    cut = min(frequency * f_number * COLORS_NM[_REFERENCE] * 1e-6, 1.0)
    return 2.0 / np.pi * (np.arccos(cut) - cut * np.sqrt(1.0 - cut**2))
