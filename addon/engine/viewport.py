"""The Rendered viewport: the frame of a 3D view, refined while nothing changes.

Blender reports changes (`Viewport.note_updates`) and asks for a redraw (`Viewport.draw`). A redraw
takes about as long as one lens sample; plan and passes are those of the final render. While the
view moves, the bokeh is a draft; the final render's follows, step by step, when the view rests. 3D
views that show the same objects share the buffers on the graphics device.
"""

import time
import weakref
from functools import cache

from ..device import context as device_context
from ..device import state
from ..errors import AplanatError
from ..levels.choosing import meshes_with_levels
from ..levels.level_store import level_store
from ..scene.extract import SceneExtractor
from ..scene.settings import read_preview_sampling
from ..scene.view import read_view
from ..snapshot.changes import Change, compare
from ..snapshot.scene import SceneSnapshot
from .bokeh.marks import shows_marks
from .drawing.scene_buffers import SceneBuffers
from .frame.pipeline import FrameRenderer
from .outcome import note_highlights, note_sampling
from .pacing import Pacer
from .planning.plan import plan_frame
from .report import frame_report, in_short

# Seconds of a redraw; a single sample may take longer.
DRAW_SECONDS = 0.02
# Seconds without a change after which a view rests: longer than the pause between two movements of
# a hand.
REST_SECONDS = 0.2


class _ViewedScene:
    """The scene content of one or several 3D views, and its buffers on the device.

    Parameters
    ----------
    space : bpy.types.SpaceView3D or None
        A 3D view in local view or with collections of its own; None for all others.
    """

    def __init__(self, space):
        self.buffers = SceneBuffers()
        self._extractor = SceneExtractor(space, device_context.max_texture_size())
        # The handle closes itself when no 3D view shows the scene any more.
        self.levels = level_store().open()
        self._wanted = set()
        self._least_triangles = None
        self._generation = self.levels.generation

    def note_updates(self, depsgraph):
        self._extractor.note_updates(depsgraph)

    def content(self, depsgraph):
        """Return the current `SceneContent`, after its upload."""
        content = self._extractor.extract_content(depsgraph)
        self.buffers.update(content)
        return content

    def want_levels(self, content, plan):
        """Request the levels of detail that a frame draws."""
        self._wanted.update(meshes_with_levels(content, plan))
        self._wanted &= content.meshes.keys()
        if plan.least_triangles != self._least_triangles:
            self._least_triangles = plan.least_triangles
            self.buffers.drop_levels()
        if self._generation != self.levels.generation:
            self._generation = self.levels.generation
            self.buffers.drop_levels()
        if self._missing():
            self.levels.request(
                [mesh for uid, mesh in content.meshes.items() if uid in self._wanted],
                plan.least_triangles,
            )
            for uid in sorted(self._missing()):
                levels = self.levels.ready(uid)
                # Until they are made, full detail is drawn.
                if levels is not None:
                    self.buffers.add_levels(uid, levels)

    def levels_changed(self, version):
        """Whether a picture has to start again because its levels of detail have changed.

        Parameters
        ----------
        version : int
            `SceneBuffers.levels_version` when it started.

        Returns
        -------
        bool
            All missing levels have been made since, or those it used are out of date.
        """
        if self._generation != self.levels.generation:
            return True
        missing = self._missing()
        if not missing:
            return version != self.buffers.levels_version
        return all(self.levels.ready(uid) is not None for uid in missing)

    def _missing(self):
        return self._wanted - self.buffers.levels.keys()


# Lives as long as a viewport shows it.
_viewed_scenes = weakref.WeakValueDictionary()


def _viewed_scene(depsgraph, space):
    """Return the scene of a 3D view, shared among views that show the same objects."""
    key, filtering = _visibility_key(space)
    layer = depsgraph.view_layer
    key = (depsgraph.as_pointer(), depsgraph.scene.original.session_uid, layer.name, *key)
    scene = _viewed_scenes.get(key)
    if scene is None:
        scene = _viewed_scenes[key] = _ViewedScene(space if filtering else None)
    return scene


def _visibility_key(space):
    shown = tuple(getattr(space, name) for name in _type_switches(type(space)))
    if space.local_view is None and not space.use_local_collections and all(shown):
        return (), False
    return (space.as_pointer(), space.local_view is None, space.use_local_collections, *shown), True


@cache
def _type_switches(space_type):
    names = space_type.bl_rna.properties.keys()
    return tuple(name for name in names if name.startswith("show_object_viewport_"))


class Viewport:
    """The picture of one region of a 3D view.

    Attributes
    ----------
    text : str
        Status line: progress, or in one line why there is no picture.
    """

    def __init__(self):
        self.text = ""
        self._scene = None
        self._drawn_scene = None
        self._snapshot = None
        self._renderer = None
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
        self._scene = _viewed_scene(depsgraph, space)
        self._scene.note_updates(depsgraph)

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
            return self._draw(depsgraph, space, region, region_3d, pixel_size)
        except AplanatError as error:
            self.text = " ".join(str(error).split())
            self._snapshot = None
            return False
        except Exception:
            # Blender prints the traceback; once is enough until something changes.
            self._broken = True
            self.text = "Aplanat failed, see the console"
            raise

    def _draw(self, depsgraph, space, region, region_3d, pixel_size):
        device_context.ensure_context()
        self._scene = _viewed_scene(depsgraph, space)
        view = read_view(depsgraph, space, region, region_3d, pixel_size)
        if view is None:
            self.text = "the render region is outside the view"
            return False
        snapshot = SceneSnapshot(
            content=self._scene.content(depsgraph),
            camera=view.camera,
            film=view.film,
            sampling=read_preview_sampling(depsgraph.scene),
        )
        with state.preserved():
            self._begin_if_changed(snapshot)
            renderer = self._renderer
            if not renderer.finished():
                self._refine(renderer)
                note_sampling(depsgraph.scene, renderer.sampling)
                note_highlights(
                    depsgraph.scene, renderer.highlights, renderer.report, renderer.fates
                )
            x, y, width, height = view.rectangle
            with state.confined(x, y, width, height):
                renderer.resolve((x, y), view.pixel_size)
        self.text = f"Sample {renderer.samples_done}/{renderer.samples_expected}"
        if renderer.sampling.text:
            self.text += f" | {renderer.sampling.text}"
        if renderer.bokeh_drafted:
            self.text += " | Draft of the bokeh"
        if shows_marks(renderer.plan):
            self.text += " | Debug view of the bokeh"
        done, total = self._scene.levels.progress
        if done < total:
            self.text += f" | Levels of detail {done / total:.0%}"
        elif error := self._scene.levels.error:
            self.text += f" | No levels of detail: {error}"
        warnings = in_short(frame_report(snapshot, renderer))
        if warnings:
            self.text += f" | {warnings}"
        # A picture without its levels of detail starts again when they are made.
        return not renderer.finished() or done < total

    def _refine(self, renderer):
        if not renderer.sampled:
            first = renderer.samples_done == 0
            start = time.perf_counter()
            self._pacer.advance(renderer)
            self._drawn_seconds += time.perf_counter() - start
            if renderer.is_late(self._drawn_seconds):
                renderer.stop()
            if first:
                # Answering the movement may have taken longer than the rest.
                self._moved = time.perf_counter()
        if time.perf_counter() - self._moved >= REST_SECONDS:
            renderer.refine_bokeh()

    def _begin_if_changed(self, snapshot):
        changed = compare(self._snapshot, snapshot)
        self._snapshot = snapshot
        if self._renderer is None or self._drawn_scene is not self._scene:
            self.release()
            plan, buffers = self._plan(snapshot), self._scene.buffers
            self._renderer = FrameRenderer(plan, snapshot, buffers, drafts=True)
            self._drawn_scene = self._scene
        elif changed & Change.PICTURE or self._scene.levels_changed(self._levels_version):
            self._renderer.restart(self._plan(snapshot), snapshot, drafts=True)

    def _plan(self, snapshot):
        self._drawn_seconds = 0.0
        plan = plan_frame(snapshot)
        self._scene.want_levels(snapshot.content, plan)
        self._levels_version = self._scene.buffers.levels_version
        return plan

    def release(self):
        """Release the picture's resources on the device."""
        if self._renderer is not None:
            self._renderer.release()
            self._renderer = None
