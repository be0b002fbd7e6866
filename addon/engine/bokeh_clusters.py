"""How similar the highlights are that a frame merges (methods 9).

Similarity is measured against the circle of confusion at each highlight's own depth, so that it
needs no setting by scene or resolution.
"""

from ..passes.clusters import Similarity

# CLUSTERED: cells from half a radius of the disc to twice its diameter, as long as the disc is
# blurred by little more than its radius.
_CELL = 0.25
_EXTENT = 1.6
_HARM = 1.0
# Rounds of pairwise merging.
_PAIRS = 3

# POINT: up to so many, each is a source of its own. Beyond, those are merged that lie within a
# small share of their discs. Where discs are small, none do, but then they cost little.
POINT_BUDGET = 10000
_POINT_LEVELS = 2
_POINT_EXTENT = 1.0 / 16.0
_POINT_CELL = _POINT_EXTENT / 2**_POINT_LEVELS
_POINT_HARM = 0.1


def similarity_of(settings, count):
    """Return how similar merged highlights are.

    Parameters
    ----------
    settings : BokehSettings
    count : int
        Of the highlights.

    Returns
    -------
    Similarity or None
        None: none are merged.
    """
    if settings.model == "CLUSTERED":
        similar = settings.similarity
        pairs = _PAIRS if settings.global_merge else 0
        return Similarity(
            settings.cluster_levels,
            _CELL * similar,
            _EXTENT * similar,
            _HARM * similar**2,
            pairs,
        )
    if count <= POINT_BUDGET:
        return None
    return Similarity(_POINT_LEVELS, _POINT_CELL, _POINT_EXTENT, _POINT_HARM)
