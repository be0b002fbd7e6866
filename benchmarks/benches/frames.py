"""Frames of a scene drawn again and again, in whole or in part, and timed.

Unlike a render through Blender the scene is read and sent to the device once; what is timed is the
work of a frame: its plan, its preparation and its samples.
"""

import tempfile
import time
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

import bpy
import numpy as np

from addon.engine.drawing.scene_buffers import SceneBuffers
from addon.engine.frame.pipeline import FrameRenderer
from addon.engine.planning.plan import plan_frame
from addon.levels.choosing import meshes_with_levels
from addon.levels.level_store import LevelStore
from addon.scene.extract import SceneExtractor

# Samples between two tellings of progress.
_SLICE = 16


@dataclass(frozen=True, eq=False)
class Drawn:
    """A frame that was drawn.

    Parameters
    ----------
    picture : ndarray of shape (height, width, 3)
        Scene linear, bottom row first.
    seconds : float
        Plan, preparation and drawing; neither levels of detail nor reading the picture.
    stages : dict of str to float
        ``plan``, ``prepare``, ``draw``, in seconds.
    work : dict of str to int
        Counts of `DrawingCounts`.
    """

    picture: np.ndarray
    seconds: float
    stages: dict[str, float]
    work: dict[str, int]


class BenchScene:
    """The current scene of this process, read and sent to the device.

    Parameters
    ----------
    scene : bpy.types.Scene
        As it is to be rendered; its camera may change before `look`.
    """

    def __init__(self, scene):
        self.seconds = {}
        self._scene = scene
        self._extractor = SceneExtractor()
        self._buffers = SceneBuffers()
        # Nothing that an earlier run has left on disk may help.
        self._folder = tempfile.TemporaryDirectory()
        self._store = LevelStore(folder=Path(self._folder.name))
        self._levels = self._store.open()
        with timed(self.seconds, "extract"):
            self._read()
        with timed(self.seconds, "upload"):
            self._buffers.update(self.snapshot.content)

    def look(self):
        """Read the camera, and what else has changed."""
        self._read()
        self._buffers.update(self.snapshot.content)

    def _read(self):
        depsgraph = bpy.context.evaluated_depsgraph_get()
        self.snapshot = self._extractor.extract(depsgraph, self._set_frame)

    def _set_frame(self, frame, subframe=0.0):
        self._scene.frame_set(frame, subframe=subframe)

    def sampled(self, method, samples, **settings):
        """Return the snapshot sampled in another way, highlights as everything else.

        Settings are those of `Sampling`.
        """
        sampling = replace(
            self.snapshot.sampling,
            method=method,
            lens_samples=samples,
            target_error=None,
            progressive=False,
            **settings,
        )
        camera = replace(self.snapshot.camera, bokeh=None)
        return replace(self.snapshot, sampling=sampling, camera=camera)

    def make_levels(self, snapshot):
        """Make the levels of detail that a snapshot takes and send them to the device.

        Parameters
        ----------
        snapshot : SceneSnapshot

        Returns
        -------
        dict of str to float or int
            Seconds ``make``, then ``from_memory`` when they are asked for again, and ``upload``;
            ``meshes`` that have some.
        """
        least = snapshot.sampling.least_triangles
        seconds = {}
        for stage in ("make", "from_memory"):
            with timed(seconds, stage):
                uids = meshes_with_levels(snapshot.content, plan_frame(snapshot))
                self._levels.request([snapshot.content.meshes[uid] for uid in uids], least)
                self._levels.finish()
        # As in a render of this frame alone.
        for uid in self._buffers.levels.keys() - set(uids):
            del self._buffers.levels[uid]
        with timed(seconds, "upload"):
            for uid in uids:
                if uid not in self._buffers.levels:
                    self._buffers.add_levels(uid, self._levels.ready(uid))
        return {**seconds, "meshes": len(uids)}

    def draw(self, snapshot, samples=None, progress=None, plan=None):
        """Draw a frame.

        Parameters
        ----------
        snapshot : SceneSnapshot
        samples : int, optional
            Only so many of the plan's.
        progress : callable, optional
            Called with the number of samples done.
        plan : FramePlan, optional
            To carry out instead of the snapshot's.

        Returns
        -------
        Drawn
        """
        stages = {}
        with self._prepared(snapshot, stages, plan) as renderer:
            with timed(stages, "draw"):
                end = samples or renderer.plan.samples
                while renderer.samples_done < end:
                    renderer.advance(min(_SLICE, end - renderer.samples_done))
                    renderer.wait()
                    if progress:
                        progress(renderer.samples_done)
            picture = renderer.read_image()[..., :3]
            return Drawn(picture, sum(stages.values()), stages, _work(renderer))

    def draw_to_marks(self, snapshot, marks, progress=None):
        """Draw a frame and look at it on the way.

        Parameters
        ----------
        snapshot : SceneSnapshot
        marks : sequence of int
            Numbers of samples, growing.
        progress : callable, optional
            Called with the number of samples done.

        Yields
        ------
        (int, float, ndarray)
            Samples, seconds that drawing has taken so far, the picture.
        """
        stages = {}
        with self._prepared(snapshot, stages) as renderer:
            for mark in marks:
                with timed(stages, "draw"):
                    while renderer.samples_done < mark:
                        renderer.advance(min(_SLICE, mark - renderer.samples_done))
                        renderer.wait()
                        if progress:
                            progress(renderer.samples_done)
                yield mark, stages["draw"], renderer.read_image()[..., :3]

    def stages(self, snapshot):
        """Draw a frame stage by stage and return each stage's seconds.

        The device finishes each stage before the next begins, so that their sum is more than a
        frame takes.
        """
        seconds = {}

        @contextmanager
        def stage(name):
            with timed(seconds, name):
                yield
                renderer.wait()

        with self._prepared(snapshot, seconds) as renderer:
            renderer.advance(renderer.plan.samples, stage)
        return seconds

    @contextmanager
    def renderer(self, snapshot, plan=None):
        """Yield the `FrameRenderer` of a frame that nothing is drawn of yet."""
        with self._prepared(snapshot, {}, plan) as renderer:
            yield renderer

    @contextmanager
    def _prepared(self, snapshot, stages, plan=None):
        with timed(stages, "plan"):
            plan = plan or plan_frame(snapshot)
        with timed(stages, "prepare"):
            renderer = FrameRenderer(plan, snapshot, self._buffers)
            renderer.wait()
        try:
            yield renderer
        finally:
            renderer.release()

    def close(self):
        """Give back what the levels of detail hold."""
        self._levels.close()
        self._store.close()
        self._folder.cleanup()


@contextmanager
def timed(seconds, stage):
    """Add the duration of a `with` block to a stage.

    Parameters
    ----------
    seconds : dict of str to float
    stage : str
    """
    start = time.perf_counter()
    try:
        yield
    finally:
        seconds[stage] = seconds.get(stage, 0.0) + time.perf_counter() - start


def _work(renderer):
    counts = renderer.counts
    return {
        "lens_samples": renderer.samples_done,
        "subpixels": renderer.plan.subpixels,
        "triangles_submitted": counts.triangles,
        "triangles_full_detail": counts.triangles_full_detail,
        "draw_calls": counts.draw_calls,
        "sprites_drawn": counts.sprites_drawn,
        "sprites_copied": counts.sprites_copied,
        "texture_bytes": renderer.texture_bytes(),
        "geometry_bytes": renderer.geometry_bytes(),
    }
