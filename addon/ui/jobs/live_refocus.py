"""Live refocused pictures: made while an Image editor shows them, gone when none does.

A timer looks at the scene's settings and draws piece by piece, between Blender's own events. It
begins when an Image editor draws the image of a scene's Refocus, whatever brought it there, and
ends when no window shows such an image.
"""

import time
import traceback
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import bpy
import numpy as np
from bpy.app.handlers import persistent

from ...engine.refocus.live_picture import LivePicture
from ...engine.refocus.scene_refocus import flat_options, layers_path, read_refocus
from ...engine.shared_resources import resources
from ...errors import AplanatError
from ...layers.captured_files import load_captured
from ...layers.layer_file import is_layer_file

# Seconds between two looks at the settings while nothing is to be drawn, and between two pieces.
_LOOK_SECONDS = 0.04
_PIECE_PAUSE = 0.001
# Seconds between two looks whether a render has ended.
_RENDER_SECONDS = 0.25
# Seconds between two drawings of a panel that tells how far a picture is.
_PANEL_SECONDS = 0.25

_draw_handle = None


class LiveRefocus:
    """The live picture of one scene: reads its files, follows its settings, fills its image.

    Parameters
    ----------
    session : RenderSession

    Attributes
    ----------
    stack : LayerStack or None
        Of the picture that is shown.
    is_flat : bool
        Whether it comes of a picture with a depth pass.
    error : str
        In one line, why there is no picture; empty if there is.
    notes : tuple of str
        What the file cannot know, and settings that cannot be met.
    """

    def __init__(self, session):
        self._sources = session.sources
        self.stack, self.is_flat = None, False
        self.error, self.notes = "", ()
        self._picture = None
        self._files = ThreadPoolExecutor(1, "refocus")
        self._reading = self._wanted = None
        self._failed, self._is_broken = None, False
        self._told_share, self._told_at = None, 0.0

    @property
    def share(self):
        """Share of the picture that is done; None while there is none to be done."""
        if self._picture is None or self.error or self._picture.settings is None:
            return None
        if self.is_tracing:
            return 0.0
        if self._picture.finished:
            return 1.0
        return min(self._picture.samples_done / self._picture.settings.samples, 0.99)

    @property
    def is_reading(self):
        """Whether a file is being read."""
        return self._reading is not None

    @property
    def is_tracing(self):
        """Whether rays through the lens are being traced for the picture."""
        return self._picture is not None and not self._picture.is_planned

    @property
    def finished(self):
        """Whether the image shows the whole picture of the present settings."""
        return self._picture is not None and self._picture.finished and not self.is_reading

    @property
    def told(self):
        """What a panel tells at once, besides the share."""
        return self.finished, self.error, self.is_reading, self.is_tracing, self.notes

    def is_panel_late(self):
        """Whether a panel has told another share for some time; True once for each change."""
        now = time.perf_counter()
        if self.share == self._told_share or now - self._told_at < _PANEL_SECONDS:
            return False
        self._told_share, self._told_at = self.share, now
        return True

    def picture(self):
        """Return the whole picture, which there must be; shape (height, width, 4)."""
        return self._picture.read()

    def take(self, path, flat, stack, is_flat):
        """Show a file that somebody has read already."""
        self._wanted, self._reading, self._is_broken = (path, flat), None, False
        self._show(stack, is_flat)

    def forget_file(self):
        """Read the file again."""
        self._wanted = self._failed = None
        self._is_broken = False

    def show_again(self):
        """Fill the image again: its pixels may have been lost."""
        self._failed = None
        if self._picture is not None:
            self._picture.show_again()

    def work(self, scene, depsgraph):
        """Work for a moment: read files, draw samples.

        Parameters
        ----------
        scene : bpy.types.Scene
            Its Refocus has an image.
        depsgraph : bpy.types.Depsgraph
            Of the present frame.

        Returns
        -------
        bool
            Whether there is more to do.
        """
        if self._is_broken:
            return False
        try:
            if self._read_file(layers_path(scene), flat_options(scene)):
                # Its first piece may take long: before it, a window tells of this file.
                return True
            if self._picture is not None:
                return self._refine(scene, depsgraph) or self.is_reading
        except AplanatError as error:
            self.error = " ".join(str(error).split())
        except Exception as error:
            # Once is enough: until the settings change, or the file is read again.
            self._is_broken = self._failed is None
            self.error = f"failed, see the console: {error}"
            traceback.print_exception(error)
        return self.is_reading

    def _refine(self, scene, depsgraph):
        settings, problems = read_refocus(scene, depsgraph, self.stack, self._sources)
        if settings == self._failed:
            return False
        # Should this fail, it is not tried again before something changes.
        self._failed = settings
        self._picture.change(settings)
        pixels = self._picture.refine()
        if pixels is not None:
            fill_image(scene.aplanat.refocus.image, pixels)
        self._failed, self.error = None, ""
        self.notes = (*self.stack.report, *problems, *self._picture.report)
        return not self._picture.finished

    def _read_file(self, path, flat):
        """Begin to read a file, or take what was read; return whether there is a new one."""
        taken = False
        if self._reading is not None:
            if not self._reading.done():
                return False
            done, self._reading = self._reading, None
            self._drop_picture()
            self._show(*done.result())
            taken = True
        # Captured layers tell all themselves.
        options_count = self.stack is None or self.is_flat
        known, of_options = self._wanted or (None, None)
        if path != known or (options_count and flat != of_options):
            self._wanted, self._failed = (path, flat), None
            self._reading = self._files.submit(read_file, path, flat)
        return taken

    def _show(self, stack, is_flat):
        self._drop_picture()
        self.stack, self.is_flat, self.error = stack, is_flat, ""
        self._picture = LivePicture(stack)

    def _drop_picture(self):
        if self._picture is not None:
            self._picture.release()
        self._picture = self.stack = None

    def close(self):
        """Give everything back."""
        self._files.shutdown(wait=False, cancel_futures=True)
        self._drop_picture()


def read_file(path, flat):
    """Read a captured file.

    Parameters
    ----------
    path : Path
    flat : FlatOptions

    Returns
    -------
    stack : LayerStack
    is_flat : bool
        Whether it is a picture with a depth pass.

    Raises
    ------
    InputError
        If it cannot be used.
    """
    return load_captured(Path(path), flat), not is_layer_file(path)


def make_image(image, width, height):
    """Return an image that a picture fits into: the one that is there, or a new one.

    Parameters
    ----------
    image : bpy.types.Image or None
    width, height : int

    Returns
    -------
    bpy.types.Image
        Generated, float, scene linear, premultiplied.
    """
    if image is None or image.source != "GENERATED" or not image.is_float:
        image = bpy.data.images.new("Refocus", width, height, alpha=True, float_buffer=True)
        image.alpha_mode = "PREMUL"
        # As a render: with the scene's exposure and look.
        image.use_view_as_render = True
    if tuple(image.size) != (width, height):
        image.generated_width, image.generated_height = width, height
    return image


def fill_image(image, pixels):
    """Put a picture into an image.

    Parameters
    ----------
    image : bpy.types.Image
    pixels : ndarray of shape (height, width, 4)
        float32, scene linear, premultiplied, bottom row first.
    """
    height, width = pixels.shape[:2]
    if image.source != "GENERATED" or not image.is_float:
        # Somebody made it another one: it is not ours to be filled.
        raise AplanatError(f"image '{image.name}' is no generated float image any more; open again")
    if tuple(image.size) != (width, height):
        image.generated_width, image.generated_height = width, height
    image.pixels.foreach_set(np.ascontiguousarray(pixels, np.float32).ravel())


def live_of(scene):
    """Return the live picture of a scene, as `LiveRefocus`; None if none is shown."""
    return resources().live.find(scene)


def begin(scene):
    """Return the live picture of a scene, begun if it is not there; a window will show it."""
    live = resources().live.begin(scene, LiveRefocus)
    wake()
    return live


def wake():
    """Look at the settings at once."""
    if bpy.app.background:
        return
    if bpy.app.timers.is_registered(_work):
        bpy.app.timers.unregister(_work)
    bpy.app.timers.register(_work, first_interval=0.0)


def hold(scene):
    """End the live picture of a scene until `let_go`: others draw the scene's frames."""
    resources().live.hold(scene)


def let_go(scene):
    """Undo `hold`."""
    resources().live.let_go(scene)
    for _, area in shown(scene):
        area.tag_redraw()


def shown(scene):
    """Go through the Image editors that show a scene's refocused picture.

    Yields
    ------
    bpy.types.Window
    bpy.types.Area
    """
    image = scene.aplanat.refocus.image
    if image is None:
        return
    for window in bpy.context.window_manager.windows:
        if window.scene == scene:
            for area in window.screen.areas:
                if area.type == "IMAGE_EDITOR" and area.spaces.active.image == image:
                    yield window, area


def _work():
    if bpy.app.is_job_running("RENDER"):
        # It needs device and data for itself.
        return _RENDER_SECONDS
    pause, found, pictures = None, set(), resources().live
    for scene in bpy.data.scenes:
        places = [] if pictures.is_held(scene) else list(shown(scene))
        if not places:
            continue
        found.add(scene.session_uid)
        live = pictures.begin(scene, LiveRefocus)
        before = live.told
        with bpy.context.temp_override(window=places[0][0]):
            busy = live.work(scene, bpy.context.evaluated_depsgraph_get())
        if before != live.told or live.is_panel_late():
            _redraw_panels(places)
        waits = live.is_reading or live.is_tracing
        next_look = _PIECE_PAUSE if busy and not waits else _LOOK_SECONDS
        pause = next_look if pause is None else min(pause, next_look)
    pictures.keep_only(found)
    return pause


def _redraw_panels(places):
    for _, area in places:
        for region in area.regions:
            if region.type == "UI":
                region.tag_redraw()


def _note_drawing():
    """Begin the picture that an Image editor shows; it calls this whenever it draws."""
    context = bpy.context
    image = context.scene.aplanat.refocus.image
    if image is None or context.space_data.image != image:
        return
    if resources().live.is_held(context.scene):
        return
    if not bpy.app.timers.is_registered(_work):
        bpy.app.timers.register(_work, first_interval=0.0)


@persistent
def _end_all(*_):
    resources().live.close()


@persistent
def _after_undo(*_):
    for live in resources().live:
        live.show_again()


def register():
    """Follow the Image editors."""
    global _draw_handle
    _draw_handle = bpy.types.SpaceImageEditor.draw_handler_add(
        _note_drawing, (), "WINDOW", "POST_PIXEL"
    )
    bpy.app.handlers.load_pre.append(_end_all)
    bpy.app.handlers.undo_post.append(_after_undo)
    bpy.app.handlers.redo_post.append(_after_undo)


def unregister():
    """Undo `register`, and give everything back."""
    global _draw_handle
    bpy.app.handlers.redo_post.remove(_after_undo)
    bpy.app.handlers.undo_post.remove(_after_undo)
    bpy.app.handlers.load_pre.remove(_end_all)
    bpy.types.SpaceImageEditor.draw_handler_remove(_draw_handle, "WINDOW")
    _draw_handle = None
    if bpy.app.timers.is_registered(_work):
        bpy.app.timers.unregister(_work)
    _end_all()
