"""What `bench --chromatic` measures in a picture, and the aberration that it draws with."""

from dataclasses import replace

import numpy as np

from addon.engine.planning.chromatic import plan_chromatic
from addon.engine.planning.plan import plan_frame
from addon.lens_io.glasses.dispersion import glass_dispersion
from addon.sampling.chromatic import ChromaticAberration
from addon.sampling.field_maps import FieldMap, field_corner
from addon.sampling.spectral_samples import wavelengths_for

from ..reference.chromatic import displaced

# `k_l` in 1/um: violet 4 % larger than red in the corners, so that fringes are plain to see.
_LATERAL = 0.1
# Smaller wiggles of a fringe's profile than this share of its height are no bands.
_LEAST_BAND = 0.02


def aberration(mode="SPECTRAL", focal_length=0.05, axial=1.0, lateral=_LATERAL, **others):
    """Return the chromatic aberration of a single lens of the usual glass."""
    return ChromaticAberration(mode, axial, lateral, glass_dispersion(), focal_length, **others)


def with_aberration(snapshot, chromatic):
    """Return a snapshot whose camera has another chromatic aberration, or None."""
    return replace(snapshot, camera=replace(snapshot.camera, chromatic=chromatic))


def weaker(field_map):
    """Return a map without the pole of its last atom, which moves points over each other."""
    return FieldMap(field_map.f) if field_map.g == "RECIPROCAL" else field_map


def sampled_plan(snapshot, importance):
    """Return a frame's plan with wavelengths by importance, or evenly drawn and only weighted."""
    plan = plan_frame(snapshot)
    camera, film, sampling = snapshot.camera, snapshot.film, snapshot.sampling
    samples = wavelengths_for(camera.chromatic, plan.samples, sampling.seed, importance)
    colors = plan_chromatic(camera.chromatic, samples, camera, film, plan.focus_distance)
    return replace(plan, chromatic=colors)


def centroid_errors(picture, snapshot, places):
    """Return how far the centroids of points are from where the model puts them, at most.

    Parameters
    ----------
    picture : ndarray of shape (height, width, 3)
        Bottom row first.
    snapshot : SceneSnapshot
        What it was drawn from, without defocus.
    places : ndarray of shape (P, 3)
        Of the points, in camera space; no two nearer to each other than 24 pixels.

    Returns
    -------
    float
        In pixels, over all points and channels.
    """
    plan = plan_frame(snapshot)
    camera, film = snapshot.camera, snapshot.film
    corner = field_corner(camera.projection, camera.orthographic)
    colors, worst = plan.chromatic, 0.0
    for place in places:
        moved = displaced(
            place[None], plan.lens_positions, colors.wavelengths_nm, camera.chromatic, 1.0, corner
        )
        clip = np.column_stack([moved, np.ones(len(moved))]) @ camera.projection.T
        ndc = clip[:, :2] / clip[:, 3:] + plan.jitter
        pixels = (ndc + 1.0) / 2.0 * (film.width, film.height)
        weights = colors.weights[:, :3]
        wanted = weights.T @ pixels / weights.sum(axis=0)[:, None]
        x, y = np.round(wanted.mean(axis=0)).astype(int)
        if not (12 <= x < film.width - 12 and 12 <= y < film.height - 12):
            continue
        part = picture[y - 12 : y + 12, x - 12 : x + 12].astype(np.float64)
        rows, columns = np.mgrid[y - 12 : y + 12, x - 12 : x + 12] + 0.5
        light = part.sum(axis=(0, 1))
        found = np.stack([(columns[..., None] * part).sum(axis=(0, 1)) / light,
                          (rows[..., None] * part).sum(axis=(0, 1)) / light], axis=1)  # fmt: skip
        worst = max(worst, float(np.abs(found - wanted).max()))
    return worst


def count_maxima(profile):
    """Return how many hills a profile has that rise out of their surroundings.

    Parameters
    ----------
    profile : ndarray of shape (K,)

    Returns
    -------
    int
        Those that are higher than the valleys to both sides by `_LEAST_BAND` of the highest one.
    """
    least = _LEAST_BAND * float(np.max(profile))
    count, rising = 0, True
    low = high = float(profile[0])
    for value in map(float, profile):
        if rising:
            high = max(high, value)
            if value < high - least:
                count, rising, low = count + 1, False, value
        else:
            low = min(low, value)
            if value > low + least:
                rising, high = True, value
    return count


def add_tint(worst, picture, plain):
    """Note how far a white wall is from one without aberration: channel means, chroma of blocks."""
    mean = np.abs(picture.mean(axis=(0, 1)) / plain.mean(axis=(0, 1)) - 1.0).max()
    height, width = picture.shape[:2]
    blocks = picture.reshape(height // 8, 8, width // 8, 8, 3).mean(axis=(1, 3))
    chroma = np.ptp(blocks, axis=-1) / blocks.mean(axis=-1)
    worst["mean"] = max(worst["mean"], float(mean))
    worst["chroma_8x8"] = max(worst["chroma_8x8"], float(chroma.max()))
