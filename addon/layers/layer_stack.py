"""A picture cut into depth layers, hidden surfaces included (methods 7).

Rows of every array run from the bottom up, as in Blender. Colours are scene linear and
premultiplied by the coverage, which is their alpha. Depths are distances along the optical axis.
"""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np


@dataclass(frozen=True)
class LayerCamera:
    """The camera of a stack of layers: a pinhole at the middle of the lens, and its lens settings.

    Parameters
    ----------
    projection : tuple of 4 tuples of 4 float
        Rows of the matrix from camera space (x right, y up, looking along -z, m) to the clip space
        of the picture without its overscan, OpenGL convention; near and far planes are arbitrary.
    orthographic : bool
    f_stop : float
        As the artist had set it; so is what follows.
    focus_distance : float
        Along the optical axis, m.
    focal_length_mm : float
        Of the camera in Blender; the aperture's radius is ``focal_length / (2 f_stop)``.
    aperture_radius : float or None
        In m, where it does not follow from these (a parallel projection); None: it does.
    blades : int
        Of the iris; 0 is round.
    blade_rotation : float
        In radians.
    aperture_ratio : float
        Height over width of the opening is ``aperture_ratio`` (anamorphic bokeh is > 1).
    view : tuple of 4 tuples of 4 float or None
        Rows of the matrix from world to camera space; None where the file does not tell.
    sensor_mm : tuple of 2 float or None
        Width and height of the part of the sensor that the picture fills; None where the file does
        not tell, and for a parallel projection.
    unit_scale : float
        Metres in a unit of the scene, as its interface showed it; depths here are as if a unit was
        a metre, as for the renderers.
    lens_settings : dict or None
        Real lens, bokeh and chromatic aberration as the artist had set them, for
        `scene.camera.lens_record`; None where the file does not tell.
    """

    projection: tuple[tuple[float, ...], ...]
    orthographic: bool = False
    f_stop: float = 2.8
    focus_distance: float = 10.0
    focal_length_mm: float = 50.0
    aperture_radius: float | None = None
    blades: int = 0
    blade_rotation: float = 0.0
    aperture_ratio: float = 1.0
    view: tuple[tuple[float, ...], ...] | None = None
    sensor_mm: tuple[float, float] | None = None
    unit_scale: float = 1.0
    lens_settings: dict | None = None


@dataclass(frozen=True, eq=False)
class DepthLayer:
    """What is seen between two depths, the nearest surface of each pixel.

    Parameters
    ----------
    color : ndarray of shape (height, width, 4)
        float32, premultiplied; alpha is the share of the pixel that is covered.
    depth : ndarray of shape (height, width)
        float32, m; inf where the layer has no surface.
    near, far : float
        Bounds of the layer, m; 0 for the foremost, inf for the last.
    passes : dict of str to ndarray of shape (height, width, channels)
        Further passes and AOVs, by name.
    """

    color: np.ndarray
    depth: np.ndarray
    near: float = 0.0
    far: float = np.inf
    passes: dict[str, np.ndarray] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class LayerStack:
    """A frame as depth layers.

    Parameters
    ----------
    layers : tuple of DepthLayer
        The foremost first, all of one size: the picture with its overscan. The world, where it is
        part of the picture, is the last one, with depth inf.
    camera : LayerCamera
    width, height : int
        Of the picture, without overscan, in pixels.
    overscan : tuple of 2 int
        Pixels that the layers are larger on the left and right, at the bottom and the top.
    pixel_aspect : float
        Height of a pixel over its width, as displayed.
    frame : int
    color_space : str
        Of the scene-linear colours, as Blender calls its working space; empty where nobody knows.
    engine : str
        Which renderer made it.
    report : tuple of str
        What the picture or file cannot know, one line each.
    fills : bool
        It is opaque, but does not know what is hidden: where the lens would see that, what is
        around it stands for it.
    """

    layers: tuple[DepthLayer, ...]
    camera: LayerCamera
    width: int
    height: int
    overscan: tuple[int, int] = (0, 0)
    pixel_aspect: float = 1.0
    frame: int = 1
    color_space: str = "Linear Rec.709"
    engine: str = ""
    report: tuple[str, ...] = ()
    fills: bool = False

    @cached_property
    def depth_range(self):
        """Least and largest finite depth, m; 2 and 1 where there is none."""
        depths = [layer.depth[np.isfinite(layer.depth)] for layer in self.layers]
        held = [found for found in depths if found.size]
        if not held:
            return 2.0, 1.0
        return float(min(d.min() for d in held)), float(max(d.max() for d in held))


def is_world(layer):
    """Whether a layer is a world: it has no depth anywhere and covers something."""
    return bool(not np.isfinite(layer.depth).any() and layer.color[..., 3].any())
