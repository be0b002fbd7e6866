"""Tiles of the lens that samples see through, for the discs of a frame: of the samples' rays."""

from functools import lru_cache, partial

from ...lens_bokeh.look import splat_pupil
from ...lens_bokeh.look.sample_beams import meridional_beams, quarter_beams
from .tiles_work import TilesWork

# Vergence of the nearest tile over that of the focus: nearer patterns only grow.
_NEAREST = 4.0
# Circles of confusion between which patterns change most, over that of infinity: at least.
_LEAST_SOFT = 1.0


# Memo of its arguments alone, of which traced rays are compared by identity: how far it has got
# does not change what it returns in the end.
@lru_cache(maxsize=2)
def ray_tiles(rays, aperture_radius, tangent):
    """Return the `TilesWork` of a lens.

    Parameters
    ----------
    rays : LensRays, CylinderRays or ArtistRays
    aperture_radius : float
        m.
    tangent : float or tuple of 2 float
        Of the field at the last tiles; along x and y of a lens with cylinders.
    """
    return TilesWork(partial(_made, rays, aperture_radius, tangent))


def _made(rays, radius, tangent):
    lay_out = meridional_beams if rays.of_revolution else quarter_beams
    beams, tangents = lay_out(rays, radius, tangent)
    yield from beams.followed()
    focus = rays.focus_vergence
    infinity = radius * focus
    soft = max(beams.softness, _LEAST_SOFT * infinity)
    yield
    nearest = min(_NEAREST * focus, rays.largest_vergence)
    ends = [infinity - radius * vergence for vergence in (0.0, nearest)]
    w_range = tuple(sorted(c / (abs(c) + soft) for c in ends))
    blur = infinity, -radius
    tiles = yield from splat_pupil.tiles_in_steps(beams.grids, tangents, blur, soft, w_range)
    return tiles, w_range, soft / infinity
