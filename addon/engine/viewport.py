"""The Rendered viewport: the frame of a 3D view, refined while nothing changes.

Blender reports changes (`Viewport.note_updates`) and asks for a redraw (`Viewport.draw`). A redraw
takes about as long as one lens sample; plan and passes are those of the final render. While the
view moves, the lens is a draft (`frame.first_picture`); the final render's samples follow, and when
the view rests its bokeh, step by step.
"""

import time
from dataclasses import replace

from ..device import context as device_context
from ..device import state
from ..errors import AplanatError
from ..scene.settings import read_preview_sampling
from ..scene.view import read_view
from ..snapshot.changes import Change, compare
from ..snapshot.scene import SceneSnapshot
from .bokeh.marks import shows_marks
from .frame.first_picture import FirstPicture
from .frame.pacing import Pacer, StageTimes
from .frame.pipeline import FrameRenderer
from .planning.plan import plan_first_picture, plan_frame
from .report import failure, frame_report, in_short, one_line
from .shared_resources import resources
from .viewport_session import session_of_view

# Seconds of a redraw; a single sample may take longer.
DRAW_SECONDS = 0.02
# Seconds without a change after which a view rests: longer than the pause between two movements of
# a hand.
REST_SECONDS = 0.2


class Viewport:
    """The picture of one region of a 3D view.

    Attributes
    ----------
    text : str
        Status line: progress, or in one line why there is no picture.
    failed : bool
        There is no picture.
    """

    def __init__(self):
        self.text = ""
        self.failed = False
        self._session = None
        self._drawn_session = None
        self._snapshot = None
        # Of the first pictures, and of the samples that follow; whether those have begun.
        self._first = self._renderer = self._first_view = None
        self._begun = False
        self._frame_time, self._stage = 0.0, ()
        self._pacer = Pacer(DRAW_SECONDS)
        self._broken = False
        self._moved = 0.0
        self._drawn_seconds = 0.0
        self._levels_version = 0

    def note_updates(self, depsgraph, space):
        """Note changes; cheap, nothing is read yet.

        Parameters
        ----------
        depsgraph : bpy.types.Depsgraph
        space : bpy.types.SpaceView3D
        """
        self._broken = False
        self._session = session_of_view(resources(), depsgraph, space)
        self._session.note_updates(depsgraph)

    def draw(self, depsgraph, space, region, region_3d, pixel_size):
        """Refine the picture and draw it into the bound frame buffer.

        Parameters
        ----------
        depsgraph : bpy.types.Depsgraph
        space : bpy.types.SpaceView3D
        region : bpy.types.Region
        region_3d : bpy.types.RegionView3D
        pixel_size : int

        Returns
        -------
        bool
            Whether another drawing would refine it further.
        """
        if self._broken:
            return False
        try:
            unfinished = self._draw(depsgraph, space, region, region_3d, pixel_size)
        except AplanatError as error:
            self._fail(depsgraph, one_line(error))
            self._snapshot = None
            return False
        except Exception as error:
            # Blender prints the traceback; once is enough until something changes.
            self._broken = True
            self._fail(depsgraph, failure(error))
            raise
        self.failed = False
        return unfinished

    def _fail(self, depsgraph, text):
        self.failed, self.text = True, text
        self._session.note_findings(depsgraph.scene, "viewport", (), text)

    def _draw(self, depsgraph, space, region, region_3d, pixel_size):
        device_context.ensure_context()
        session = self._session = session_of_view(resources(), depsgraph, space)

        def read(size):
            return read_view(depsgraph, space, region, region_3d, size, session.sources)

        settings = depsgraph.scene.original.aplanat
        times = StageTimes(self._wait) if settings.show_preview_times else None
        self._stage = (times.stage,) if times else ()
        self._frame_time = settings.preview_frame_time
        view = read(pixel_size)
        if view is None:
            self.text = "the render region is outside the view"
            return False
        snapshot = SceneSnapshot(
            content=session.content(depsgraph),
            camera=view.camera,
            film=view.film,
            sampling=read_preview_sampling(depsgraph.scene),
        )
        with state.preserved():
            changed = self._begin_if_changed(snapshot, view, read)
            if not (changed and self._first.renderer):
                # A view that moves goes on with its next picture: samples begin with the redraw
                # after that of the first picture.
                self._begin_samples(snapshot)
                if not self._renderer.finished():
                    self._refine(self._renderer)
            renderer = self._shown()
            if renderer is self._renderer:
                session.note_picture(depsgraph.scene, renderer)
            if renderer is self._first.renderer:
                view = self._first_view
            x, y, width, height = view.rectangle
            with state.confined(x, y, width, height):
                renderer.resolve((x, y), view.pixel_size)
        self.text = self._progress()
        if times:
            self.text += f" | {times.text}"
        if shows_marks(renderer.plan):
            self.text += " | Debug view of the bokeh"
        done, total = session.levels.progress
        if done < total:
            self.text += f" | Levels of detail {done / total:.0%}"
        warnings = list(frame_report(snapshot, renderer))
        if error := session.levels.error:
            warnings.append(f"no levels of detail: {error}")
        if warnings:
            self.text += f" | {in_short(warnings)}"
        share = done / total if done < total else 1.0
        session.note_findings(depsgraph.scene, "viewport", warnings, levels=round(share, 2))
        # A picture without its levels of detail starts again when they are made.
        return not (self._begun and self._renderer.finished()) or done < total

    def _shown(self):
        """Return the renderer whose picture shows more of the lens."""
        if not self._begun or self._first.is_better_than(self._renderer):
            return self._first.renderer
        return self._renderer

    def _progress(self):
        words = []
        if self._begun:
            samples = self._renderer
            words.append(f"Sample {samples.samples_done}/{samples.samples_expected}")
            if samples.sampling.text:
                words.append(samples.sampling.text)
        if self._shown() is self._first.renderer:
            words.append("Draft of the lens")
        elif self._renderer.bokeh_drafted:
            words.append("Draft of the bokeh")
        return " | ".join(words)

    def _refine(self, renderer):
        if not renderer.sampled:
            first = renderer.samples_done == 0
            start = time.perf_counter()
            self._pacer.seconds = self._frame_time or DRAW_SECONDS
            self._pacer.advance(renderer, *self._stage)
            self._drawn_seconds += time.perf_counter() - start
            if renderer.is_late(self._drawn_seconds):
                renderer.stop()
            if first:
                # Answering the movement may have taken longer than the rest.
                self._moved = time.perf_counter()
        if time.perf_counter() - self._moved >= REST_SECONDS:
            renderer.refine_bokeh()

    def _wait(self):
        """Wait for the device, as far as anything was drawn."""
        for renderer in filter(None, (self._first and self._first.renderer, self._renderer)):
            renderer.wait()

    def _begin_if_changed(self, snapshot, view, read):
        """Draw the first picture where anything has changed; return whether it has."""
        changed = compare(self._snapshot, snapshot)
        self._snapshot = snapshot
        if self._first is None or self._drawn_session is not self._session:
            self.release()
            self._first = FirstPicture(self._session.scene_buffers)
            self._drawn_session = self._session
        elif not (changed & Change.PICTURE or self._session.levels_changed(self._levels_version)):
            return False
        self._begun = False
        side = self._first.pixels.side
        self._first_view = (side > 1 and read(side * view.pixel_size)) or view
        first = replace(snapshot, camera=self._first_view.camera, film=self._first_view.film)
        plan = plan_first_picture(first)
        if plan is not None:
            self._want_levels(snapshot, plan)
        self._first.draw(first, plan, self._frame_time, *self._stage)
        self._moved = time.perf_counter()
        return True

    def _begin_samples(self, snapshot):
        """Begin the lens samples of the frame, unless they have begun."""
        if self._begun:
            return
        self._begun = True
        self._drawn_seconds = 0.0
        plan = plan_frame(snapshot)
        self._want_levels(snapshot, plan)
        # Without a first picture, a draft of the bokeh is the first of it.
        bokeh = "LATER" if self._first.renderer else "DRAFT"
        if self._renderer is None:
            buffers = self._session.scene_buffers
            self._renderer = FrameRenderer(plan, snapshot, buffers, bokeh)
        else:
            self._renderer.restart(plan, snapshot, bokeh)

    def _want_levels(self, snapshot, plan):
        self._session.want_levels(snapshot.content, plan)
        self._levels_version = self._session.scene_buffers.levels_version

    def release(self):
        """Release the picture's resources on the device."""
        for part in filter(None, (self._first, self._renderer)):
            part.release()
        self._first = self._renderer = None
