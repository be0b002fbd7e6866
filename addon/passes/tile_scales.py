"""Dividing the sums of samples by their weights, tile by tile."""

from dataclasses import dataclass

from ..sampling.tile_control import TILE

# Corners along the sides of a tile that sums may be given at.
CORNERS = (2, 5, 17)
# What a pass can divide by: the same everywhere, one number a tile, sums at corners of tiles.
KINDS = (None, 1, *CORNERS)


@dataclass(frozen=True, eq=False)
class TileScales:
    """Weights of the samples of each tile of `sampling.tile_control.TILE` px.

    Parameters
    ----------
    texture : GPUTexture
        One over the summed weights by channel, a texel a tile; with several corners the sums there,
        a square of texels a tile.
    corners : int
        Along each side of a tile, from edge to edge: 1 or one of `CORNERS`.
    """

    texture: object
    corners: int = 1


def defines(corners):
    """Return the defines of a shader that divides by a kind of weights."""
    if corners is None:
        return ()
    return (("TILED", "1"), ("TILE", str(TILE)), ("CORNERS", str(corners)))
