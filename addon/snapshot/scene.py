"""The scene of one frame as frozen values: no Blender object survives in here.

Lengths are in Blender units, which the engine takes as metres as Cycles does; matrices act on
column vectors; images have their first row at the bottom, as in Blender. Every array is
read-only by agreement. Large parts (meshes, images, surfaces) carry a `uid`: the same uid means the
same content, so that buffers on the graphics device are reused and a change is found by comparing
snapshots.
"""

from dataclasses import dataclass

from ..layers.layer_stack import LayerStack
from .camera import Camera
from .content import SceneContent
from .film import Film, Sampling


@dataclass(frozen=True, eq=False)
class SceneSnapshot:
    """Everything a frame needs.

    Parameters
    ----------
    content : SceneContent
    camera : Camera
    film : Film
    sampling : Sampling
    passes : tuple of str
        Names as in Blender: ``"Combined"``, ``"Depth"``, ...
    layer_name : str
    alpha_threshold : float
        Opacity below which a surface is left out of Depth, Normal and their like.
    stack : LayerStack or None
        A captured picture that is seen through the lens instead of the content.
    """

    content: SceneContent
    camera: Camera
    film: Film
    sampling: Sampling
    passes: tuple[str, ...] = ("Combined",)
    layer_name: str = ""
    alpha_threshold: float = 0.5
    stack: LayerStack | None = None
