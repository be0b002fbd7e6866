"""Light maps: how far from a place on a light the nearest surface is, and how surfaces read them.

A lens sample sees the light from one or several places. What light does not reach from there is
taken from the light of all lamps: over the samples shadows become as soft as the lamps are large,
and what no shadow falls on is free of noise.
"""

from dataclasses import dataclass

from ...device import state
from . import surface, surface_target

# Of what hides light: only its depth is drawn.
TARGET = surface_target.SurfaceTarget(
    "passes/surface/light_map_frag.glsl", (), defines=("OF_LIGHT",), shades=False
)

# Light samples that a drawing is lit by at most: a byte of a push constant each.
MOST_MAPS = 32
# Those by which all drawings shadow what may be splatted.
MOST_STEADY = 8
# Places in the atlas of light maps, from 1 to what a byte holds.
MOST_PLACES = 255
# Of a light sample's row: what it is, and its views of the scene.
MOST_VIEWS = 6
VIEW_TEXELS = 5
HEAD_TEXELS = 3
ROW_TEXELS = HEAD_TEXELS + MOST_VIEWS * VIEW_TEXELS


@dataclass(frozen=True)
class Lighting:
    """What lit surfaces read of the lights in one drawing.

    Parameters
    ----------
    table : GPUTexture
        Lights and light samples, see `light_table`.
    maps : GPUTexture
        The atlas of light maps.
    places, steady : tuple of int
        Light samples of the drawing, and those by which all drawings shadow what is so bright that
        it may be splatted; `packed` into 8 and into 2.
    """

    table: object
    maps: object
    places: tuple[int, ...]
    steady: tuple[int, ...]

    def bind(self, shader):
        """Set what `surface.surface_info` has declared for lit surfaces in a bound shader."""
        shader.uniform_sampler("lights_tx", self.table)
        if not shader.declares("light_maps_tx"):
            return
        shader.uniform_sampler("light_maps_tx", self.maps)
        shader.uniform_int("light_places", self.places[:4])
        shader.uniform_int("more_light_places", self.places[4:])
        shader.uniform_int("steady_places", self.steady)


def packed(places, words):
    """Pack places in the atlas into whole numbers of push constants.

    Parameters
    ----------
    places : sequence of int
        From 0 to `MOST_PLACES` - 1, at most 4 a word.
    words : int

    Returns
    -------
    tuple of int
    """
    found = [0] * words
    for number, place in enumerate(places):
        found[number // 4] |= (place + 1) << (8 * (number % 4))
    # As signed numbers of 32 bits.
    return tuple(word - (1 << 32) if word >= 1 << 31 else word for word in found)


def draw(draws, view_buffer, instances, number):
    """Draw what hides light into the bound depth target.

    Parameters
    ----------
    draws : list of surface.Draw
        Made for `TARGET`.
    view_buffer : GPUUniformBuf
        `ViewParams` of the light's view.
    instances : GPUTexture
    number : int
        Of the light sample: decides by chance which light passes transparent surfaces.
    """
    state.opaque()
    surface.draw_sample(draws, view_buffer, instances, (0.0,) * 4, number)
