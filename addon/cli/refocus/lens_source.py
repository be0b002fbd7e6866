"""The lens of `aplanat refocus`: a scene's camera or what was captured, and options over it."""

from contextlib import contextmanager
from dataclasses import replace

import bpy

from ...engine.refocus.camera_settings import camera_settings
from ...lens_io.recorded_lens import RecordedShelf
from ...scene.camera.camera import evaluated_camera
from ...scene.camera.lens_record import apply_lens, recorded_file
from ..render.scene_setup import (
    check_camera,
    find_lens,
    load_scene,
    use_blades,
    use_camera,
    use_distortion,
    use_lens,
)


class LensSource:
    """Says how each frame is seen; the scene's file is opened once and never changed.

    Parameters
    ----------
    arguments : argparse.Namespace
        Of `aplanat refocus`.
    sources : CameraSources
        Of the session.

    Raises
    ------
    InputError
        If the scene cannot be opened or has no such camera, or there is no such lens.
    """

    def __init__(self, arguments, sources):
        self._arguments = arguments
        self._sources = sources
        self._scene = None
        if arguments.scene is not None:
            self._scene = load_scene(arguments.scene)
            if arguments.camera is not None:
                use_camera(self._scene, arguments.camera)
        self._lens_id = find_lens(arguments.lens)

    def settings(self, stack, frame):
        """Return how a captured picture is seen.

        Parameters
        ----------
        stack : LayerStack
        frame : int
            Of the scene.

        Returns
        -------
        settings : RefocusSettings
        problems : tuple of str
            Warnings about settings that cannot be met, one line each.

        Raises
        ------
        InputError
            If there is no camera, or it does not take the lens that was asked for.
        """
        if self._scene is not None:
            # Markers of the timeline may switch to another camera.
            self._scene.frame_set(frame)
            check_camera(self._scene)
            return self._read(stack, self._scene.camera)
        sources, of_record = self._recorded(stack)
        with _captured_camera(stack) as camera:
            found, problems = self._read(stack, camera, sources)
        # With all digits.
        iris = found.iris if self._arguments.blades is not None or found.iris.opening else None
        values = {"focus_distance": None, "f_stop": None, "iris": iris}
        return self._with_numbers(replace(found, **values)), (*of_record, *problems)

    def _recorded(self, stack):
        """Return the library with the lens that was captured with, and warnings about it."""
        recorded = recorded_file(stack.camera.lens_settings)
        if recorded is None or self._lens_id is not None:
            return self._sources, ()
        shelf = RecordedShelf(self._sources.shelf, *recorded)
        problems = (f"{shelf.problem}; --lens takes one of the library",) if shelf.problem else ()
        return replace(self._sources, shelf=shelf), problems

    def _read(self, stack, camera, sources=None):
        asked = self._arguments
        if self._lens_id is not None:
            use_lens(camera, self._lens_id, asked.lens)
        if asked.blades is not None:
            use_blades(camera.data, asked.blades)
        if asked.distortion is not None:
            use_distortion(camera.data, asked.distortion)
        bpy.context.view_layer.update()
        depsgraph = bpy.context.evaluated_depsgraph_get()
        seen = evaluated_camera(depsgraph, camera)
        numbers = (asked.samples, asked.seed)
        sources = sources or self._sources
        found, problems = camera_settings(stack, depsgraph, seen, sources, *numbers)
        if asked.no_bokeh:
            found = replace(found, bokeh=None)
        if asked.no_chromatic:
            found = replace(found, chromatic=None)
        return self._with_numbers(found), problems

    def _with_numbers(self, settings):
        asked = self._arguments
        if asked.focus is not None:
            settings = replace(settings, focus_distance=asked.focus)
        if asked.fstop is not None:
            settings = replace(settings, f_stop=asked.fstop)
        return settings


@contextmanager
def _captured_camera(stack):
    """Stand a camera with the captured settings in the scene while a `with` block lasts."""
    captured = stack.camera
    data = bpy.data.cameras.new("captured")
    data.type = "ORTHO" if captured.orthographic else "PERSP"
    data.lens = captured.focal_length_mm
    dof = data.dof
    dof.aperture_blades, dof.aperture_rotation = captured.blades, captured.blade_rotation
    dof.aperture_ratio = captured.aperture_ratio
    dof.focus_distance, dof.aperture_fstop = captured.focus_distance, captured.f_stop
    image = apply_lens(captured.lens_settings or {}, data)
    camera = bpy.data.objects.new("captured", data)
    bpy.context.scene.collection.objects.link(camera)
    try:
        yield camera
    finally:
        curves = data.aplanat.chromatic.curves
        bpy.data.objects.remove(camera)
        bpy.data.cameras.remove(data)
        if curves is not None:
            bpy.data.node_groups.remove(curves)
        if image is not None:
            bpy.data.images.remove(image)
