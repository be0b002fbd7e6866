"""Tiles of a lens with cylinders, for the discs of a frame; as those of others in `real_tiles`."""

from functools import lru_cache

from ...lens_bokeh.look import cylinder_beams
from ...lens_bokeh.look.cylinder_beams import CylinderBeams

# Vergence of the nearest tile over that of the focus: nearer patterns only grow.
_NEAREST = 4.0
# Circles of confusion between which patterns change most, over that of infinity: at least.
_LEAST_SOFT = 0.02


# Memo of its arguments alone, of which rays and grid are compared by identity.
@lru_cache(maxsize=2)
def cylinder_tiles(rays, aperture_radius, grid, largest):
    """Draw the tiles of a lens with cylinders.

    Parameters
    ----------
    rays : CylinderRays
    aperture_radius : float
        m.
    grid : FieldGrid
        Of the picture.
    largest : tuple of 2 float
        Tangents of the farthest fields along x and y.

    Returns
    -------
    tiles : PupilTiles
    w_range : tuple of 2 float
        Of the first and last depth.
    soft : float
        c0 over the circle of confusion of infinity.
    """
    focus = rays.focus_vergence
    beams = CylinderBeams(rays, aperture_radius, grid, largest)
    infinity = aperture_radius * focus
    soft = max(beams.softness, _LEAST_SOFT * infinity)
    nearest = min(_NEAREST * focus, rays.largest_vergence)
    ends = [infinity - aperture_radius * vergence for vergence in (0.0, nearest)]
    w_range = tuple(sorted(c / (abs(c) + soft) for c in ends))
    blur = infinity, -aperture_radius
    return cylinder_beams.cylinder_tiles(beams, blur, soft, w_range), w_range, soft / infinity
