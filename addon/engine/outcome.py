"""The outcome of a render: error, cancellation, warnings, statistics and pictures.

The engine fills the outcome of the session that a render belongs to (`session.RenderSession`);
whoever starts a render and wants to know listens (`shared_resources.listen`). Pictures are kept
only for a listener that asked for them.
"""

import time
from contextlib import contextmanager
from dataclasses import dataclass, field

import numpy as np

from ..errors import StrictError


@dataclass
class RenderStatistics:
    """Work and time of a render, summed over its view layers.

    Attributes
    ----------
    seconds : dict of str to float
        By stage: ``extract``, ``plan``, ``upload``, ``draw``, ``resolve``, ``read_back``.
    lens_samples : int
        Sum over all view layers.
    subsamples : float
        Mean number of subsamples of a lens sample, in the view layer with most.
    decimations, replays : int
        Meshes whose levels of detail were made by simplification, and by collapses known before.
    subpixels : int
        Along each side of a pixel in a lens sample's raster, of the finest view layer.
    draw_calls : int
    triangles_submitted, triangles_full_detail : int
        Over all lens samples; the second as if every sample were drawn at full detail.
    sprites_drawn, sprites_copied : int
    highlights : dict of str to int
        ``found``, ``clustered``, ``culled_size``, ``culled_occlusion``, ``culled_cone``,
        ``masked``, ``splatted``.
    thresholds : tuple of 2 float or None
        The least and the largest automatic threshold of highlights; None where there was none.
    uploads : dict of str to int
        Meshes, images, materials and instance tables sent to the device.
    shaders_compiled : int
        During this render; compiling is part of ``upload`` and of the first samples' ``draw``.
    texture_bytes, geometry_bytes : int
        Memory on the device, of the view layer that took most.
    device : str
    noise : SamplingReport or None
        Sampling of the view layer with the largest error.
    """

    seconds: dict[str, float] = field(default_factory=dict)
    lens_samples: int = 0
    subsamples: float = 0.0
    decimations: int = 0
    replays: int = 0
    subpixels: int = 1
    draw_calls: int = 0
    triangles_submitted: int = 0
    triangles_full_detail: int = 0
    sprites_drawn: int = 0
    sprites_copied: int = 0
    highlights: dict[str, int] = field(
        default_factory=lambda: dict.fromkeys(
            (
                "found",
                "clustered",
                "culled_size",
                "culled_occlusion",
                "culled_cone",
                "masked",
                "splatted",
            ),
            0,
        )
    )
    thresholds: tuple[float, float] | None = None
    uploads: dict[str, int] = field(default_factory=dict)
    shaders_compiled: int = 0
    texture_bytes: int = 0
    geometry_bytes: int = 0
    device: str = ""
    noise: object = None

    def note_thresholds(self, thresholds):
        """Widen `thresholds` to those of one more view layer or view, a pair or None."""
        known = [pair for pair in (self.thresholds, thresholds) if pair]
        if known:
            self.thresholds = (min(p[0] for p in known), max(p[1] for p in known))

    def note_noise(self, report):
        """Add the sampling report of a view layer."""
        if self.noise is None or (report.error or 0.0) > (self.noise.error or 0.0):
            self.noise = report

    @contextmanager
    def timed(self, stage):
        """Add the duration of a `with` block to a stage."""
        start = time.perf_counter()
        try:
            yield
        finally:
            elapsed = time.perf_counter() - start
            self.seconds[stage] = self.seconds.get(stage, 0.0) + elapsed


@dataclass(frozen=True, eq=False)
class PassPicture:
    """One pass of one view layer.

    Parameters
    ----------
    channels : str
        A letter each, as given to `RenderEngine.register_pass`: ``"RGBA"``, ``"X"``, ``"XYZ"``.
        Those of Cryptomatte are small, ``"rgba"``: they are data, not colours.
    pixels : ndarray of shape (height, width, len(channels))
        float32, bottom row first.
    """

    channels: str
    pixels: np.ndarray


@dataclass(frozen=True, eq=False)
class LayerPicture:
    """The passes of one view of a view layer.

    Parameters
    ----------
    scene, layer : str
        Names.
    view : str
        Name of the view of a stereoscopic render; empty where there is only one.
    region : tuple of 4 int
        x, y, width, height of the pixels in the whole picture, y from the bottom.
    size : tuple of 2 int
        Width and height of the whole picture.
    passes : dict of str to PassPicture
        By Blender's name of the pass.
    metadata : dict of str to str
        For the picture file, such as Cryptomatte's manifests.
    """

    scene: str
    layer: str
    view: str
    region: tuple[int, int, int, int]
    size: tuple[int, int]
    passes: dict[str, PassPicture]
    metadata: dict[str, str] = field(default_factory=dict)


@dataclass
class RenderOutcome:
    """Everything that the engine reports about a render.

    Attributes
    ----------
    error : Exception or None
        Why there is no picture: an `AplanatError`, or another exception if Aplanat has a fault.
    cancelled : bool
    statistics : RenderStatistics
    layers : list of LayerPicture
        Empty unless the listener keeps pictures.
    report : list of str
        Warnings: what could not be drawn and what was drawn instead, each line once.
    keeps_pictures : bool
    progress : callable or None
        Called with the finished share of the view layer, 0 to 1, and a line of text.
    strict : bool
        A warning ends the render as soon as it is found.
    """

    error: Exception | None = None
    cancelled: bool = False
    statistics: RenderStatistics = field(default_factory=RenderStatistics)
    layers: list[LayerPicture] = field(default_factory=list)
    report: list[str] = field(default_factory=list)
    keeps_pictures: bool = False
    progress: object = None
    strict: bool = False

    def note(self, lines):
        """Add lines to the report that are not there yet."""
        self.report.extend(line for line in dict.fromkeys(lines) if line not in self.report)

    def check_strict(self):
        """Raise an error if there are warnings and the listener is strict.

        Raises
        ------
        StrictError
        """
        if self.strict and self.report:
            raise StrictError(self.report)
