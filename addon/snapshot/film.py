"""Film and sampling settings of one frame, as frozen values."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Film:
    """The raster.

    Parameters
    ----------
    width, height : int
        Of the whole picture, in pixels.
    region : tuple of 4 int
        x, y, width, height of the part that is rendered; y from the bottom.
    transparent : bool
        The world is left out of the picture.
    filter_kind : {'BLACKMAN_HARRIS', 'BOX'}
    filter_size_px : float
        As Blender's filter size.
    """

    width: int
    height: int
    region: tuple[int, int, int, int]
    transparent: bool = False
    filter_kind: str = "BLACKMAN_HARRIS"
    filter_size_px: float = 1.5


@dataclass(frozen=True)
class Sampling:
    """Sampling settings: method, numbers of samples, noise threshold, levels of detail.

    The defaults are those of a plain exact frame, for values that are made by hand. A scene's
    settings have their own in `settings.scene_settings`, and say every field (`scene.settings`).

    Parameters
    ----------
    method : {'REFERENCE', 'ADAPTIVE', 'LAYERED'}
    lens_samples : int
    seed : int
    target_error : float or None
        Noise threshold of the adaptive method, as 1 - SSIM: samples are drawn until the error is
        below it, and `subsamples`, `reuse_grid` and `level_bias` are chosen from it. None: a fixed
        number of samples, and those settings as they are.
    least_samples, most_samples : int
        Bounds of the lens samples with a target error.
    time_limit : float or None
        Seconds of drawing after which sampling stops, whatever the method.
    subsamples : int
        Places on the lens that each lens sample stands for besides its own, on the average.
    reuse_grid : int
        Cells along a pixel in which lens samples share a drawing; 0 shares none.
    uses_levels : bool
        Blurred objects are drawn at a lower level of detail.
    level_bias : float
        Subtracted from the level of detail.
    least_triangles : int
        No level of detail has fewer.
    progressive : bool
        The picture may be looked at before all samples are drawn.
    reference_bokeh : bool
        The reference method, too, splats highlights as bokeh, instead of sampling them.
    layers : int
        Depth layers of the layered method.
    layer_source : {'SLICES', 'PEELING'}
        What a layer is: a slice of depth, or what lies behind the layer before in each texel.
    layers_from_eyes : bool
        The layers' colours depend on the place on the lens that they are seen from.
    cones : bool
        Its rays are as thick as their distance from one another asks for.
    shadows : bool
        Objects shadow one another from the lights.
    """

    method: str = "REFERENCE"
    lens_samples: int = 128
    seed: int = 0
    target_error: float | None = None
    least_samples: int = 1
    most_samples: int = 4096
    time_limit: float | None = None
    subsamples: int = 0
    reuse_grid: int = 2
    uses_levels: bool = True
    level_bias: float = 0.0
    least_triangles: int = 256
    progressive: bool = False
    reference_bokeh: bool = False
    layers: int = 8
    layer_source: str = "SLICES"
    layers_from_eyes: bool = False
    cones: bool = True
    shadows: bool = False
