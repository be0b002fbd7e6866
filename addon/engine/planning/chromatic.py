"""Chromatic aberration in a frame plan: a sample's wavelength, focus and scale over the field.

The numpy twin of ``lib/chromatic_lib.glsl``: the displacement of vertices by the shader is applied
here to the corners of bounding boxes, for frustum culling, bounds of circles of confusion, and the
sharing of drawings.

The field is a plane at 1 m from the lens, its middle on the optical axis, which need not be the
picture's middle (lens shift); for a parallel projection it is the plane of the lens itself. The
tables of the field maps run over the distance from the axis in that plane, which is the tangent of
the tilt: the device then needs no arc tangent.
"""

from dataclasses import dataclass, replace

import numpy as np

from ...sampling.chromatic import LEAST_FOCAL_SHARE, LEAST_SCALE
from ...sampling.spectral_bands import spectral_bands
from .field_table import diamond_turn, field_of_raster, field_table, picture_radius


@dataclass(frozen=True, eq=False)
class FieldRanges:
    """Ranges of focus and lateral scale over all wavelengths within bounding boxes.

    Parameters
    ----------
    inverse_focus : ndarray of shape (2, I)
        Least and largest inverse of the focus distance, 1/m.
    scale : ndarray of shape (2, I)
        Least and largest lateral scale.
    """

    inverse_focus: np.ndarray
    scale: np.ndarray


@dataclass(frozen=True, eq=False)
class ChromaticPlan:
    """The wavelengths of a frame's samples, their weights, focus and lateral scale.

    Parameters
    ----------
    wavelengths_nm : ndarray of shape (N,)
    weights : ndarray of shape (N, 4)
        Of red, green, blue and alpha, which is their mean.
    focal_errors : ndarray of shape (N,)
        Relative difference of the focal length on the axis from the reference wavelength's.
    lateral_strengths : ndarray of shape (N,)
        Relative magnification of objects where the lateral map is 1.
    table : ndarray of shape (R, C, 2)
        float32, axial and lateral map; columns: distance from the axis in the field, from 0 to
        `radius`; rows: round the axis, see `diamond_angles`; one row for radial maps.
    radius : float
        Distance of the picture's outermost corner from the axis in the field, where t is 1.
    parallel : bool
        The projection is a parallel one.
    focal_length : float
        Of the reference wavelength, m.
    inverse_focus : float
        At the reference wavelength, 1/m.
    raster : ndarray of shape (4,)
        Mapping from pixels of the region to the field: scale and offset, x and y each.
    typical_errors : tuple of 2 float
        Two focal errors whose circles of confusion have about the mean square of all wavelengths'.
    traced : bool
        The colours are those of the real lens that samples see through (`lens_plan`): here, all
        wavelengths are like the reference.
    """

    wavelengths_nm: np.ndarray
    weights: np.ndarray
    focal_errors: np.ndarray
    lateral_strengths: np.ndarray
    table: np.ndarray
    radius: float
    parallel: bool
    focal_length: float
    inverse_focus: float
    raster: np.ndarray
    typical_errors: tuple[float, float]
    traced: bool = False

    def dispersion(self, sample):
        """Return a sample's focal error and lateral strength, 2 floats."""
        return float(self.focal_errors[sample]), float(self.lateral_strengths[sample])

    def with_samples(self, aberration, samples):
        """Return the same aberration with other samples; parameters as of `plan_chromatic`."""
        found = replace(self, **_sampled(aberration, samples))
        return found.through_lens() if self.traced else found

    def through_lens(self):
        """Return the plan whose colours are left to a real lens."""
        nothing = np.zeros(len(self.wavelengths_nm))
        return replace(
            self,
            focal_errors=nothing,
            lateral_strengths=nothing,
            table=np.zeros_like(self.table),
            typical_errors=(0.0, 0.0),
            traced=True,
        )

    @property
    def samples_for_one(self):
        """Number of samples of one wavelength that are worth one of all, mean of the channels."""
        colors = self.weights[:, :3]
        return float((len(colors) * np.square(colors).sum(axis=0) / colors.sum(axis=0) ** 2).mean())

    def strengths(self, eye):
        """Return axial and lateral map at points of camera space.

        Parameters
        ----------
        eye : ndarray of shape (..., 3)

        Returns
        -------
        ndarray of shape (..., 2)
        """
        place = self._places(eye)
        rows, columns = self.table.shape[:2]
        away = np.minimum(np.linalg.norm(place, axis=-1) / self.radius, 1.0) * (columns - 1)
        column = np.minimum(away.astype(int), columns - 2)
        turn = diamond_turn(place) * rows / 4.0
        row = np.minimum(turn.astype(int), rows - 1)
        along, across = (away - column)[..., None], (turn - row)[..., None]
        if rows == 1:
            across = np.zeros_like(across)
        table = self.table.astype(np.float64)

        def between(at):
            return table[at, column] * (1.0 - along) + table[at, column + 1] * along

        return between(row) * (1.0 - across) + between((row + 1) % rows) * across

    def displaced(self, eye, lens_positions, samples=slice(None)):
        """Return the displaced positions of points, in the pinhole's camera space, by sample.

        Parameters
        ----------
        eye : ndarray of shape (P, 3)
        lens_positions : ndarray of shape (N, 2)
            In m.
        samples : slice or ndarray
            Which of the plan's samples the positions belong to.

        Returns
        -------
        ndarray of shape (N, P, 3)
        """
        axial, lateral = np.moveaxis(self.strengths(eye), -1, 0)
        errors = self.focal_errors[samples, None]
        focus = self.inverse_focus_at(errors, axial)
        scale = np.maximum(1.0 + self.lateral_strengths[samples, None] * lateral, LEAST_SCALE)
        moved = np.broadcast_to(eye, (len(errors), *eye.shape)).copy()
        moved[..., :2] *= scale[..., None]
        moved[..., :2] -= lens_positions[:, None] * (1.0 + eye[:, 2] * focus)[..., None]
        return moved

    def inverse_focus_at(self, focal_error, axial):
        """Return the inverse of the focus distance, 1/m, equations (4.5) and (4.7).

        Below 0 the focus lies beyond infinity.

        Parameters
        ----------
        focal_error, axial : array_like, broadcast
            Of the wavelength, and the axial map.
        """
        ratio = np.maximum(1.0 + focal_error * (1.0 - axial), LEAST_FOCAL_SHARE)
        return self.inverse_focus + (1.0 / ratio - 1.0) / self.focal_length

    def ranges(self, corners):
        """Return the ranges of focus and scale over all wavelengths within bounding boxes.

        Parameters
        ----------
        corners : ndarray of shape (I, 8, 3)
            In camera space.

        Returns
        -------
        FieldRanges
        """
        return self._ranges(*self._columns(corners))

    def overall(self):
        """Return the `ranges` of the whole field, each of shape (2,)."""
        found = self._ranges(np.zeros(1, int), np.full(1, self.table.shape[1] - 1))
        return FieldRanges(found.inverse_focus[:, 0], found.scale[:, 0])

    def _ranges(self, first, last):
        low, high = _extremes(self.table.min(axis=0), self.table.max(axis=0), first, last)
        kept = 1.0 - np.stack([high[:, 0], low[:, 0]])
        ends = self.focal_errors.min(), self.focal_errors.max()
        # The inverse focus falls as the focal length grows.
        focus = self.inverse_focus_at(np.array(ends)[:, None, None], 1.0 - kept)
        lateral = np.stack([low[:, 1], high[:, 1]])
        ends = self.lateral_strengths.min(), self.lateral_strengths.max()
        scale = np.maximum(1.0 + np.array(ends)[:, None, None] * lateral, LEAST_SCALE)
        return FieldRanges(
            np.stack([focus.min(axis=(0, 1)), focus.max(axis=(0, 1))]),
            np.stack([scale.min(axis=(0, 1)), scale.max(axis=(0, 1))]),
        )

    def _places(self, eye):
        if self.parallel:
            return eye[..., :2]
        return eye[..., :2] / np.maximum(-eye[..., 2:], 1e-9)

    def _columns(self, corners):
        """Return the first and the last column of the table that boxes touch."""
        place = self._places(corners)
        low, high = place.min(axis=1), place.max(axis=1)
        nearest = np.linalg.norm(np.maximum(np.maximum(low, -high), 0.0), axis=1)
        farthest = np.linalg.norm(place, axis=2).max(axis=1)
        if not self.parallel:
            behind = (corners[..., 2] >= 0.0).any(axis=1)
            nearest = np.where(behind, 0.0, nearest)
            farthest = np.where(behind, np.inf, farthest)
        columns = self.table.shape[1]
        reach = np.minimum(np.stack([nearest, farthest]) / self.radius, 1.0) * (columns - 1)
        return np.floor(reach[0]).astype(int), np.ceil(reach[1]).astype(int)


def plan_chromatic(aberration, samples, camera, film, focus_distance):
    """Plan the chromatic aberration of a frame.

    Parameters
    ----------
    aberration : sampling.chromatic.ChromaticAberration
    samples : sampling.spectral_samples.SpectralSamples
    camera : Camera
    film : Film
    focus_distance : float
        In m.

    Returns
    -------
    ChromaticPlan
    """
    # Mean and width of the whole spectrum, independent of the wavelengths of the samples.
    (light,) = spectral_bands(aberration, 0.0, 0.0, 1)
    deviation = light.focal_width / np.sqrt(12.0)
    radius = camera.field_radius or picture_radius(camera.projection, camera.orthographic)
    return ChromaticPlan(
        **_sampled(aberration, samples),
        table=field_table(aberration, radius, camera.orthographic),
        radius=radius,
        parallel=camera.orthographic,
        focal_length=aberration.focal_length,
        inverse_focus=1.0 / focus_distance,
        raster=field_of_raster(camera.projection, film),
        typical_errors=(light.focal_error - deviation, light.focal_error + deviation),
    )


def _sampled(aberration, samples):
    return {
        "wavelengths_nm": samples.wavelengths_nm,
        "weights": np.column_stack([samples.weights, samples.weights.mean(axis=1)]),
        "focal_errors": aberration.focal_errors(samples.wavelengths_nm),
        "lateral_strengths": aberration.lateral_strengths(samples.wavelengths_nm),
    }


def _extremes(low, high, first, last):
    """Return the minima and maxima of runs of columns, from a sparse table as N-buffers are.

    Parameters
    ----------
    low, high : ndarray of shape (C, 2)
    first, last : ndarray of shape (I,)
        int; the last is inside.

    Returns
    -------
    tuple of two ndarray of shape (I, 2)
    """
    found = np.empty((2, len(first), 2))
    length = last - first + 1
    level = 0
    low, high = low.astype(np.float64), high.astype(np.float64)
    while len(first) and (1 << level) <= length.max():
        here = (length >> level) == 1
        span = 1 << level
        a, b = first[here], last[here] - span + 1
        found[0, here] = np.minimum(low[a], low[b])
        found[1, here] = np.maximum(high[a], high[b])
        # Blocks that would reach beyond the end are never looked up.
        low[:-span], high[:-span] = (
            np.minimum(low[:-span], low[span:]),
            np.maximum(high[:-span], high[span:]),
        )
        level += 1
    return found[0], found[1]
