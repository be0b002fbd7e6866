"""How much work drawing a frame was."""

from dataclasses import astuple, dataclass


@dataclass
class DrawingCounts:
    """Work done so far.

    Attributes
    ----------
    draw_calls, triangles, sprites_drawn, sprites_copied : int
    triangles_full_detail : int
        Triangles of every instance at full detail, for every sample.
    """

    draw_calls: int = 0
    triangles: int = 0
    triangles_full_detail: int = 0
    sprites_drawn: int = 0
    sprites_copied: int = 0

    def __add__(self, other):
        """Return the sum of two counts."""
        return DrawingCounts(*(a + b for a, b in zip(astuple(self), astuple(other), strict=True)))
