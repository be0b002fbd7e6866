"""One frame captured: depths measured, slices rendered, layers put together.

Who captures renders: `FrameCapture.steps` asks for one render after the other, so that it may be
done at once or between the events of a window.
"""

import math
from dataclasses import dataclass, replace
from pathlib import Path

import bpy
import numpy as np

from ..errors import InputError, UnfinishedFileError
from ..layers.cuts import OVERLAP
from ..layers.layer_stack import DepthLayer, LayerStack
from ..layers.render_picture import read_render
from ..layers.slices import (
    DENOISED_OVERLAP,
    filled_depth,
    is_surface,
    kept_ends,
    mending,
    plan_slices,
)
from .scene_limits import limits_of
from .shot_copy import ShotCopy

# A slice of nothing but smoke has no depth: what is said of where it is, m.
_FARTHEST = 1e6


@dataclass(frozen=True)
class Step:
    """A render that a capture waits for.

    Parameters
    ----------
    scene : bpy.types.Scene
        To be rendered as a still, and written to its own output path.
    view_layer : bpy.types.ViewLayer
        The one of it that is rendered.
    text : str
        What it is, for people.
    done, total : int
        Renders before it, and all of the frame as far as is known.
    """

    scene: bpy.types.Scene
    view_layer: bpy.types.ViewLayer
    text: str
    done: int
    total: int


def render_now(step):
    """Render a step, and return when it is rendered.

    Raises
    ------
    InputError
        If Blender does not render it.
    """
    # The operator's own option for a scene renders it at the frame of the context's scene.
    with bpy.context.temp_override(scene=step.scene):
        try:
            bpy.ops.render.render(write_still=True)
        except RuntimeError as error:
            reason = str(error).strip().splitlines()[0].removeprefix("Error: ")
            raise InputError(f"Blender does not render this scene: {reason}") from error


class FrameCapture:
    """The capture of a frame while a `with` block lasts.

    Parameters
    ----------
    scene : bpy.types.Scene
    frame : int
    settings : CaptureSettings
    folder : Path
        For the pictures of slices.

    Attributes
    ----------
    warnings : list of str
        What of the scene is not in the layers.
    words : dict of str to str
        What renderers say in the headers of their files.
    """

    def __init__(self, scene, frame, settings, folder):
        self._shot = ShotCopy(scene, frame, settings)
        self._frame = frame
        self._settings = settings
        self._path = Path(folder) / "slice.exr"
        self.words = {}

    def __enter__(self):
        """Copy the scene; see `ShotCopy`."""
        self._shot.__enter__()
        self.warnings = self._shot.warnings
        return self

    def __exit__(self, *error):
        """Remove the copy."""
        self._path.unlink(missing_ok=True)
        self._shot.__exit__(*error)

    def steps(self):
        """Yield the renders that are needed, as `Step`.

        Returns
        -------
        LayerStack
            As the generator's value.

        Raises
        ------
        InputError
            If the scene cannot be captured.
        UnfinishedFileError
            If a render left no picture.
        """
        shot = self._shot
        self._total = self._settings.layers + 1 + shot.has_world
        self._done = 0
        shot.measure_depths(True)
        depth = (yield from self._render("measuring depths")).depth
        shot.measure_depths(False)
        seen = depth[is_surface(depth)]
        report = list(limits_of(shot.scene, shot.layer))
        if not seen.size:
            report.append("there is no surface in view: one layer is all there is")
        slices = plan_slices(
            self._settings.layers,
            float(seen.min()) if seen.size else math.inf,
            float(seen.max()) if seen.size else math.inf,
            *shot.clip,
            shot.camera.orthographic,
            DENOISED_OVERLAP if shot.denoises else OVERLAP,
        )
        self._total = len(slices) + 1 + shot.has_world
        layers, guessed, before, waiting = [], 0, None, None
        # What a layer keeps of its end depends on the next one.
        for number, slice_ in enumerate([*slices, None]):
            picture, coverage = None, None
            if slice_ is not None:
                shot.aim(slice_)
                picture = yield from self._render(f"layer {number + 1} of {len(slices)}")
                coverage = np.clip(_finite(picture.color[..., 3]), 0.0, 1.0)
            if waiting is not None:
                layer, unknown = _layer(*waiting, coverage)
                guessed += unknown
                layers.append(layer)
            waiting, before = (picture, slice_, before), coverage
        if guessed:
            report.append(
                f"{guessed} pixels show something without a depth (smoke, or finer than a pixel):"
                " they are taken to be in the middle of their layer"
            )
        if shot.has_world:
            shot.aim_at_world()
            picture = yield from self._render("the world")
            world = _world(picture, slices[-1])
            if world.color[..., 3].any():
                layers.append(world)
        render = shot.scene.render
        return LayerStack(
            layers=tuple(layers),
            camera=shot.camera,
            width=shot.size[0],
            height=shot.size[1],
            overscan=shot.overscan,
            pixel_aspect=render.pixel_aspect_y / render.pixel_aspect_x,
            frame=self._frame,
            color_space=bpy.data.colorspace.working_space,
            engine=self._settings.engine,
            report=tuple(report),
        )

    def _wanted(self, name):
        # Comes with every denoised picture; it is wanted where denoising data is.
        return name != "Noisy Image" or self._shot.stores_noise

    def _render(self, text):
        scene = self._shot.scene
        scene.render.filepath = str(self._path)
        self._path.unlink(missing_ok=True)
        yield Step(scene, scene.view_layers[self._shot.layer], text, self._done, self._total)
        self._done += 1
        if not self._path.is_file() or not self._path.stat().st_size:
            raise UnfinishedFileError(
                f"frame {self._frame}: {self._settings.engine} left no picture of {text} in"
                f" '{self._path.parent}'; is the disk full? TMPDIR names another place"
            )
        try:
            picture = read_render(self._path, self._shot.layer)
        except InputError as error:
            raise UnfinishedFileError(
                f"frame {self._frame}: {self._settings.engine} left no whole picture of {text}"
                f" ({error}); is the disk full? TMPDIR names another place"
            ) from error
        self.words |= picture.words
        passes = {name: pixels for name, pixels in picture.passes.items() if self._wanted(name)}
        return replace(picture, passes=passes)


def _finite(pixels):
    """Replace NaN by 0 and infinities by the largest float, as engines divide by zero."""
    largest = np.finfo(np.float32).max
    return np.nan_to_num(pixels, copy=True, nan=0.0, posinf=largest, neginf=-largest)


def _layer(picture, slice_, before, behind):
    color = _finite(picture.color)
    color[..., 3] = np.clip(color[..., 3], 0.0, 1.0)
    mended = 1.0
    if before is not None:
        mended = mending(before, color[..., 3])[..., None]
    middle = slice_.near + min(slice_.far, 2.0 * slice_.near + 1.0) if slice_.near else slice_.far
    otherwise = min(0.5 * middle, slice_.clip_end, _FARTHEST)
    depth, guessed = filled_depth(picture.depth, color[..., 3], otherwise)
    weights = slice_.weights(depth)
    if behind is not None:
        weights[kept_ends(color[..., 3], behind)] = 1.0
    weights = weights[..., None] * mended
    passes = {
        # Light is premultiplied as the picture is; coordinates and ids are as they are.
        name: (_finite(pixels) * weights if name in picture.light else pixels)
        for name, pixels in picture.passes.items()
    }
    color *= weights
    depth[color[..., 3] == 0.0] = np.inf
    return DepthLayer(color, depth, slice_.near, slice_.far, passes), guessed


def _world(picture, last):
    color = _finite(picture.color)
    color[..., 3] = np.clip(color[..., 3], 0.0, 1.0)
    depth = np.full(color.shape[:2], np.inf, np.float32)
    light = {name: pixels for name, pixels in picture.passes.items() if name in picture.light}
    return DepthLayer(color, depth, last.clip_end, math.inf, light)
