"""Tiles of an artist's lens, for the discs of a frame; as those of a real lens in `look`."""

from functools import lru_cache

from ...lens_bokeh.look.artist_beams import ArtistBeams
from ...lens_bokeh.look.splat_pupil import pupil_tiles

# Vergence of the nearest tile over that of the focus: nearer patterns only grow.
_NEAREST = 4.0
# Circles of confusion between which patterns change most, over that of infinity: at least.
_LEAST_SOFT = 0.02


# Memo of its arguments alone; see `look`.
@lru_cache(maxsize=2)
def artist_tiles(rays, tangent):
    """Draw the tiles of an artist's lens.

    Parameters
    ----------
    rays : lens_bokeh.samples.artist_rays.ArtistRays
    tangent : float
        Of the field at the last tiles.

    Returns
    -------
    tiles : PupilTiles
    w_range : tuple of 2 float
        Of the first and last depth.
    soft : float
        c0 over the circle of confusion of infinity.
    """
    radius, focus = rays.aperture_radius, rays.focus_vergence
    beams = ArtistBeams(rays.lens, rays.opening, rays.corner, radius, focus, tangent)
    infinity = radius * focus
    soft = max(beams.softness, _LEAST_SOFT * infinity)
    ends = [infinity - radius * vergence for vergence in (0.0, _NEAREST * focus)]
    w_range = tuple(sorted(c / (abs(c) + soft) for c in ends))
    tiles = pupil_tiles(beams, 0.0, (infinity, -radius), soft, w_range)
    return tiles, w_range, soft / infinity
