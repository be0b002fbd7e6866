"""Light maps: how far from a place on a light the nearest surface is, and how surfaces read them.

A lens sample sees each light from one or several places. From how many of them something hides it
decides how much of it arrives: over the samples shadows become as soft as the lamps are large, and
what no shadow falls on is free of noise.
"""

from dataclasses import dataclass

from ...device import state
from . import surface, surface_target

# Of what hides light: only its depth is drawn.
TARGET = surface_target.SurfaceTarget(
    "passes/surface/light_map_frag.glsl",
    (),
    defines=("OF_LIGHT", "STRAIGHT"),
    shades=False,
    straight=True,
)

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
    lists : GPUTexture
        Light samples of the drawing, and those by which all drawings shadow what is so bright that
        it may be splatted; `light_table.list_texels`.
    """

    table: object
    maps: object
    lists: object

    def bind(self, shader):
        """Set what `surface.surface_info` has declared for lit surfaces in a bound shader."""
        shader.uniform_sampler("lights_tx", self.table)
        if shader.declares("light_maps_tx"):
            shader.uniform_sampler("light_maps_tx", self.maps)
            shader.uniform_sampler("lit_by_tx", self.lists)


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
