"""The list of a frame's highlights, which grows as they are found (methods 9)."""

from ...device.shaders import ShaderInfo, compile_shader, dispatch
from ...device.targets import Targets, TargetSpec
from . import highlights
from .highlights import COLUMNS

# Room at first, and of a side of the groups that copy.
_ROOM = 1 << 16
_THREADS = 8


_COPY = ShaderInfo(
    name="aplanat_highlight_list",
    compute="""void main()
{
  ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
  if (texel.y < textureSize(from_tx, 0).y) {
    imageStore(to_img, texel, texelFetch(from_tx, texel, 0));
  }
}
""",
    samplers=(("FLOAT_2D", "from_tx"),),
    images=(("RGBA32F", "FLOAT_2D", "to_img", ("WRITE",)),),
    local_size=(_THREADS, _THREADS, 1),
)


class HighlightList:
    """A list of highlights, as `highlights.emit` writes it.

    Parameters
    ----------
    room : int, optional
        For how many there is room at first.

    Attributes
    ----------
    count : int
        Of highlights.
    """

    def __init__(self, room=_ROOM):
        self._targets = _made(room)
        self.count = 0

    @property
    def textures(self):
        """The list, two textures; others when it has grown."""
        return self._targets["a"], self._targets["b"]

    @property
    def bytes(self):
        """Memory on the device."""
        return self._targets.bytes

    def append(self, raster, lists, tiles):
        """Append the highlights of a raster; parameters as of `highlights.emit`.

        Returns
        -------
        int
            As of `highlights.emit`: pixels whose circle of confusion is too small.
        """
        count, sharp = highlights.emit(raster, lists, tiles, self.textures, self.count)
        if self.count + count > COLUMNS * self._targets.height:
            # What was found before stays: to search for it again takes far longer.
            before = self._grow(self.count + count)
            highlights.emit(raster, lists, tiles, self.textures, self.count)
            # The device has read it, as that has waited.
            before.release()
        self.count += count
        return sharp

    def release(self):
        """Release the textures."""
        self._targets.release()

    def _grow(self, least):
        """Make room for at least so many; return what held the list before."""
        before = self._targets
        self._targets = _made(max(least, 2 * COLUMNS * before.height))
        shader = compile_shader(_COPY)
        for name in ("a", "b"):
            shader.bind()
            shader.uniform_sampler("from_tx", before[name])
            shader.image("to_img", self._targets[name])
            dispatch(shader, COLUMNS // _THREADS, -(-before.height // _THREADS))
        return before


def _made(room):
    return Targets(COLUMNS, -(-room // COLUMNS), [TargetSpec(name, "RGBA32F") for name in "ab"])
