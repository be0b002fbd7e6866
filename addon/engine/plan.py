"""From a snapshot to a frame plan: every number a frame needs, decided before anything is drawn."""

from dataclasses import dataclass

import numpy as np

from ..sampling.sequence import lens_samples, pixel_offsets


@dataclass(frozen=True, eq=False)
class FramePlan:
    """What the pipeline carries out.

    Parameters
    ----------
    width, height : int
        Of the rendered region, in pixels.
    view : ndarray of shape (4, 4)
        World to camera space.
    projection : ndarray of shape (4, 4)
        Camera space to clip space of the region.
    focus_distance : float
        In m.
    lens_positions : ndarray of shape (N, 2)
        Places on the lens, in m.
    jitter : ndarray of shape (N, 2)
        Sub-pixel movement in clip units of the region.
    """

    width: int
    height: int
    view: np.ndarray
    projection: np.ndarray
    orthographic: bool
    focus_distance: float
    lens_positions: np.ndarray
    jitter: np.ndarray

    @property
    def samples(self):
        """Number of lens samples."""
        return len(self.lens_positions)


def region_projection(projection, film):
    """Restrict a projection to the rendered region of the film.

    Parameters
    ----------
    projection : ndarray of shape (4, 4)
        Camera space to clip space of the whole picture.
    film : Film

    Returns
    -------
    ndarray of shape (4, 4)
    """
    x, y, width, height = film.region
    crop = np.eye(4)
    crop[0, 0] = film.width / width
    crop[1, 1] = film.height / height
    crop[0, 3] = (film.width - 2 * x - width) / width
    crop[1, 3] = (film.height - 2 * y - height) / height
    return crop @ projection


def plan_frame(snapshot):
    """Plan a frame.

    Parameters
    ----------
    snapshot : SceneSnapshot

    Returns
    -------
    FramePlan
    """
    film, camera, sampling = snapshot.film, snapshot.camera, snapshot.sampling
    _, _, width, height = film.region
    count = sampling.lens_samples
    lens = camera.lens
    if lens is None or lens.aperture_radius == 0.0:
        positions, focus = np.zeros((count, 2)), 1.0
    else:
        points = lens_samples(0, count, lens.iris, sampling.seed)
        positions, focus = points * lens.aperture_radius, lens.focus_distance
    offsets = pixel_offsets(0, count, film.filter_kind, film.filter_size_px, sampling.seed)
    return FramePlan(
        width=width,
        height=height,
        view=camera.view,
        projection=region_projection(camera.projection, film),
        orthographic=camera.orthographic,
        focus_distance=focus,
        lens_positions=positions,
        # A sample at +x in the pixel sees what lies to its right: the picture moves to the left.
        jitter=-2.0 * offsets / np.array([width, height]),
    )
