"""What tells the light that is splatted from the light that lens samples draw, on the device.

Whoever draws or lists light binds the same, so that nothing is lost and nothing counts twice.
"""

from dataclasses import dataclass


@dataclass(frozen=True, eq=False)
class SplitLight:
    """Resources of the split.

    Parameters
    ----------
    buffer : GPUUniformBuf
        `HighlightParams`.
    surroundings : GPUTexture
        The pyramid of means of `passes.bokeh.surroundings`; any where the threshold is not
        automatic.
    candidates : GPUTexture
        R32UI, a texel a tile of the raster of the search: 0 where the light of surfaces that only
        reflect is left to the lens samples.
    """

    buffer: object
    surroundings: object
    candidates: object

    def bind(self, shader):
        """Bind what a shader declares of it."""
        shader.uniform_block("highlight_buf", self.buffer)
        for name, texture in (
            ("surroundings_tx", self.surroundings),
            ("candidates_tx", self.candidates),
        ):
            if shader.declares(name):
                shader.uniform_sampler(name, texture)
