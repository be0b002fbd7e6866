"""The part of a frame plan that concerns depth layers (methods 7)."""

from dataclasses import dataclass, field

import numpy as np

from ...layers.layer_stack import LayerStack
from .field_table import field_of_clip

# Sets of places on the lens: the pixels of a square of 4 x 4 have one each, so that what few
# samples leave is fine noise instead of bands.
SETS = 16
# How far layers reach beyond the frame at most, as a share of the whole picture's longer side: with
# more, texels of what is in view would be coarser. A part of it is no place where less is seen.
_OVERSCAN = 0.25


@dataclass(frozen=True, eq=False)
class LayeredPlan:
    """How a frame is drawn through depth layers.

    Parameters
    ----------
    count : int
        Layers.
    places : ndarray of shape (SETS, N, 2)
        Places on the lens, m; the first set is that of the plan.
    cell : float
        Side of the part of the lens that a ray stands for, m; 0 casts thin rays.
    culls : bool
        Layers that a ray cannot meet are skipped.
    stack : LayerStack or None
        The layers, of a captured picture; None: those of the scene.
    peeled : bool
        Layers of the scene are what lies behind one another in each texel; else slices of depth.
    eyes : ndarray of shape (E, 2)
        Places on the lens that the layers' colours are seen from, m: its middle, or that and four
        places round it, right, left, up and down.
    origin : tuple of 2 int
        Of a captured picture: pixels of its layers on the left of and below what is drawn.
    in_step : bool
        All sets of places are the first one.
    overscan : int
        Pixels that the layers of a scene reach beyond the frame at most.
    """

    count: int
    places: np.ndarray
    cell: float
    culls: bool = True
    stack: LayerStack | None = None
    peeled: bool = False
    eyes: np.ndarray = field(default_factory=lambda: np.zeros((1, 2)))
    origin: tuple[int, int] = (0, 0)
    in_step: bool = False
    overscan: int = 0


def plan_layered(sampling, film, source, stack=None, projection=None):
    """Plan the depth layers of a frame.

    Parameters
    ----------
    sampling : Sampling
    film : Film
    source : SampleSource
        Of the frame's lens samples.
    stack : LayerStack or None
    projection : ndarray of shape (4, 4), optional
        Of what is drawn of a captured picture.

    Returns
    -------
    LayeredPlan or None
        None for another method.
    """
    if sampling.method != "LAYERED":
        return None
    places = source.lens_sets(sampling.lens_samples, SETS)
    cell = 0.0
    if source.lens is not None and sampling.cones:
        different = len(np.unique(places[0], axis=0))
        extent = source.lens.aperture_radius**2 / source.lens.iris.ratio
        cell = float(np.sqrt(source.lens.iris.shared_area * extent / different))
    if stack is not None:
        origin = _origin(stack, projection)
        return LayeredPlan(len(stack.layers), places, cell, stack=stack, origin=origin)
    eyes = np.zeros((1, 2))
    extent = np.abs(places).max(axis=(0, 1))
    if sampling.layers_from_eyes and extent.min() > 0.0:
        eyes = np.array([(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1)]) * extent
    peeled = sampling.layer_source == "PEELING"
    overscan = int(_OVERSCAN * max(film.width, film.height))
    return LayeredPlan(sampling.layers, places, cell, peeled=peeled, eyes=eyes, overscan=overscan)


def _origin(stack, projection):
    """Return the lower left corner of the drawn picture in the layers, px."""
    captured = np.array(stack.camera.projection)
    corner = field_of_clip(np.array([-1.0, -1.0]), projection)
    # A field's place is affine in that of the clip space.
    none, one = (field_of_clip(np.full(2, place), captured) for place in (-1.0, 1.0))
    place = (corner - none) / (one - none) * (stack.width, stack.height) + stack.overscan
    return tuple(np.round(place).astype(int).tolist())
