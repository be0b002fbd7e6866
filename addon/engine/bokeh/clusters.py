"""Bounds of similarity within which a frame's highlights are clustered (methods 9).

Similarity is measured against the circle of confusion at each highlight's own depth, so that no
setting depends on the scene or the resolution.
"""

from ...passes.bokeh.clusters import Similarity

# CLUSTERED: sides of cells from half a radius of the disc to twice its diameter and more, while the
# merged disc is blurred by at most its diameter. Largest harm of one merge, and of all merges
# together: their changes of the picture add up.
_CELL = 0.3
_EXTENT = 2.0
_HARM = 1.5
_HARM_OF_ALL = 7500.0
# Rounds of pairwise merging.
_PAIRS = 3

# AUTO: largest number of highlights that are not merged. Beyond, faint ones are merged, the more
# the more there are: where so many discs overlap, no disc's edge shows. Cells are long in depth,
# because discs of all depths overlap; such merges change while the camera turns, but without
# visible harm.
POINT_BUDGET = 10000
_POINT_LEVELS = 3
_POINT_CELL = 0.125
_POINT_EXTENT = 0.5
_POINT_LENGTH = 16.0
# Harm allowed for each POINT_BUDGET of highlights, and its maximum.
_POINT_HARM = 0.003
_POINT_MOST_HARM = 0.03


def similarity_of(settings, count):
    """Return the bounds of similarity within which highlights are merged.

    Parameters
    ----------
    settings : BokehSettings
    count : int
        Number of highlights.

    Returns
    -------
    Similarity or None
        None: no highlights are merged.
    """
    if settings.model == "CLUSTERED":
        similar = settings.similarity
        pairs = _PAIRS if settings.global_merge else 0
        return Similarity(
            settings.cluster_levels,
            _CELL * similar,
            _EXTENT * similar,
            min(_HARM, _HARM_OF_ALL / max(count, 1)) * similar**2,
            pairs,
        )
    if settings.model == "POINT" or count <= POINT_BUDGET:
        return None
    harm = min(_POINT_HARM * (count / POINT_BUDGET - 1.0), _POINT_MOST_HARM)
    return Similarity(_POINT_LEVELS, _POINT_CELL, _POINT_EXTENT, harm, length=_POINT_LENGTH)
