"""How similar the highlights are that a frame merges (methods 9).

Similarity is measured against the circle of confusion at each highlight's own depth, so that it
needs no setting by scene or resolution.
"""

from ...passes.bokeh.clusters import Similarity

# CLUSTERED: cells from half a radius of the disc to twice its diameter and more, as long as it is
# blurred by no more than its diameter. The harm of one merge, at most, and that of as many as there
# are highlights: what each changes adds up.
_CELL = 0.3
_EXTENT = 2.0
_HARM = 1.5
_HARM_OF_ALL = 7500.0
# Rounds of pairwise merging.
_PAIRS = 3

# AUTO: up to so many, each is a source of its own. Beyond, faint ones are merged, the more the
# more there are: where so many discs overlap, none shows its edge. Cells are long, because discs of
# all depths overlap; merges that do no harm may change while the camera turns.
POINT_BUDGET = 10000
_POINT_LEVELS = 3
_POINT_CELL = 0.125
_POINT_EXTENT = 0.5
_POINT_LENGTH = 16.0
# For each budget of highlights, and at most.
_POINT_HARM = 0.003
_POINT_MOST_HARM = 0.03


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
            min(_HARM, _HARM_OF_ALL / max(count, 1)) * similar**2,
            pairs,
        )
    if settings.model == "POINT" or count <= POINT_BUDGET:
        return None
    harm = min(_POINT_HARM * (count / POINT_BUDGET - 1.0), _POINT_MOST_HARM)
    return Similarity(_POINT_LEVELS, _POINT_CELL, _POINT_EXTENT, harm, length=_POINT_LENGTH)
