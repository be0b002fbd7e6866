"""Render targets: named textures and the frame buffers over them.

Whoever makes targets releases them (``with Targets(...) as targets``); no pass allocates.
"""

import math
from dataclasses import dataclass

from ..errors import DeviceLimitError
from . import census, keeping
from .context import max_texture_size


@dataclass(frozen=True)
class TargetSpec:
    """One target.

    Parameters
    ----------
    name : str
    texel_format : str
    layers : int
        Of an array texture; 0 is a plain one.
    scale : float
        How many times larger than the others it is, along each side, rounded up.
    size : tuple of 2 int or None
        Width and height of one that is not as large as the others.
    """

    name: str
    texel_format: str
    layers: int = 0
    scale: float = 1
    size: tuple[int, int] | None = None


class Targets:
    """Textures of one size or multiples of it, by name, and frame buffers over sets of them.

    Parameters
    ----------
    width, height : int
        In pixels.
    specs : iterable of TargetSpec
    """

    def __init__(self, width, height, specs):
        limit = max_texture_size()
        if max(width, height) > limit:
            raise DeviceLimitError(
                f"{limit} pixels a side",
                f"a picture of {width} x {height} pixels was asked for"
                " (render it in parts with a render border)",
            )
        self.width = width
        self.height = height
        self.bytes = 0
        self.textures = {}
        self._framebuffers = {}
        for spec in specs:
            self.add(spec)

    def __enter__(self):
        """Return itself; `release` follows at the end of the `with` block."""
        return self

    def __exit__(self, *exception):
        """Release the textures."""
        self.release()

    def __getitem__(self, name):
        """Return the texture called `name`."""
        return self.textures[name]

    def __contains__(self, name):
        """Whether there is a texture called `name`."""
        return name in self.textures

    def add(self, spec):
        """Make one more texture."""
        import gpu

        width, height = spec.size or (
            math.ceil(side * spec.scale) for side in (self.width, self.height)
        )
        size = census.texture_bytes(width, height, spec.texel_format, spec.layers)
        try:
            texture = gpu.types.GPUTexture(
                (width, height), layers=spec.layers, format=spec.texel_format
            )
        except RuntimeError as error:
            raise DeviceLimitError(
                "less than that",
                f"a picture of {self.width} x {self.height} pixels needs {size / 2**30:.1f} GiB for"
                f" '{spec.name}' beside {self.bytes / 2**30:.1f} GiB for what it has already"
                " (render it in parts with a render border)",
            ) from error
        self.textures[spec.name] = census.record("texture", texture, size)
        self.bytes += size

    def clear(self, name, value):
        """Fill the colour texture called `name` with a vector of 4."""
        self.textures[name].clear(format="FLOAT", value=value)

    def framebuffer(self, *color, depth=None):
        """Return the frame buffer over the named colour targets and depth target."""
        import gpu

        key = (color, depth)
        framebuffer = self._framebuffers.get(key)
        if framebuffer is None:
            framebuffer = gpu.types.GPUFrameBuffer(
                color_slots=tuple(self.textures[name] for name in color),
                depth_slot=self.textures[depth] if depth else None,
            )
            self._framebuffers[key] = census.record("framebuffer", framebuffer)
        return framebuffer

    def forget_framebuffers(self):
        """Make the frame buffers anew when they are next asked for.

        They belong to the window whose context was active when they were made, and drawing into
        them with another window's silently does nothing; textures belong to all windows. So no
        frame buffer may outlive a stretch of work that is certain to be in one window.
        """
        self._framebuffers.clear()

    def release(self):
        """Release the textures."""
        self._framebuffers.clear()
        self.textures.clear()
        self.bytes = 0
        keeping.let_go()


def level_count(width, height):
    """Return how many levels a pyramid has, the last of which is one square."""
    return max(1, (max(width, height) - 1).bit_length())


def level_sizes(width, height):
    """Return the size of each level of a pyramid, from level 1 on."""
    return [
        tuple(-(-side // 2**level) for side in (width, height))
        for level in range(1, level_count(width, height) + 1)
    ]


def atlas_size(width, height):
    """Return the size of the texture that holds all levels; see ``lib/pyramid_atlas_lib.glsl``.

    Returns
    -------
    tuple of 2 int
    """
    sizes = level_sizes(width, height)
    right = max((w for w, _ in sizes[1:]), default=0)
    above = max((second_row(height, level) + h for level, (_, h) in enumerate(sizes, 1)))
    return sizes[0][0] + right, max(sizes[0][1], above)


def second_row(height, level):
    """Return the lowest row of a level in the second column; see ``level_origin``."""
    last = max(height - 1, 1).bit_length()
    whole = 1 << last
    return 0 if level < 2 else (whole >> 1) - (whole >> (level - 1)) + max(level - last - 1, 0)
