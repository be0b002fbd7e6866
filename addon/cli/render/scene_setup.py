"""Loading a .blend file and applying the options of the command line.

The loaded scene is changed in memory and never saved.
"""

import math
import os
from pathlib import Path

import bpy

from ...engine.render_engine import ENGINE_ID
from ...engine.shared_resources import shelf
from ...errors import CameraError, FocusError, InputError
from ...lens_io.library import Library
from ...scene.camera.lenses import user_folder
from ...settings.scene_part_settings import DISTORTION, LENS
from ...settings.setting import settings_of
from .sampling_arguments import apply_sampling

# Upper bound of the bytes of a pixel: targets on the device, read-back, Blender's result and the
# picture file together.
_BYTES_PER_PIXEL = 160


def load_scene(path):
    """Open a .blend file and return its scene.

    Parameters
    ----------
    path : Path

    Raises
    ------
    InputError
        If there is no such file or Blender cannot read it.
    """
    path = Path(path)
    if not os.path.isfile(path):
        raise InputError(f"scene file '{path}' does not exist; check the path")
    if not os.access(path, os.R_OK):
        raise InputError(f"scene file '{path}' cannot be read; check its permissions")
    try:
        bpy.ops.wm.open_mainfile(filepath=str(path.resolve()), load_ui=False)
    except RuntimeError as error:
        # Blender's reports come as lines that start with "Error: ".
        reason = str(error).strip().splitlines()[0].removeprefix("Error: ")
        raise InputError(
            f"scene file '{path}' is not a readable .blend file ({reason}); save it again with"
            " Blender"
        ) from error
    return bpy.context.scene


def apply_options(scene, arguments):
    """Apply the options of `render` to a scene.

    Parameters
    ----------
    scene : bpy.types.Scene
    arguments : argparse.Namespace

    Raises
    ------
    InputError
        If one of them does not fit the scene.
    """
    render, settings = scene.render, scene.aplanat
    if arguments.resolution:
        render.resolution_x, render.resolution_y = arguments.resolution
        render.resolution_percentage = 100
    apply_sampling(settings, render, arguments)
    if arguments.camera:
        use_camera(scene, arguments.camera)
    use_engine(scene)
    check_size(scene)


def apply_frame(scene, frame, arguments, lens_id=None):
    """Go to a frame and apply the lens options to its camera.

    Parameters
    ----------
    scene : bpy.types.Scene
    frame : int
    arguments : argparse.Namespace
    lens_id : str, optional
        What `find_lens` returned for ``--lens``.

    Raises
    ------
    InputError
        If there is no camera, an option does not fit the scene, or its animation overrules it.
    """
    # Markers of the timeline may switch to another camera.
    scene.frame_set(frame)
    check_camera(scene)
    if lens_id is not None:
        use_lens(scene.camera, lens_id, arguments.lens)
    if arguments.exposure:
        _stop_animation(scene.camera.data, "aplanat.exposure")
        exposure = settings_of(LENS)["exposure"].identifier(arguments.exposure)
        scene.camera.data.aplanat.exposure = exposure
    for name, strength in arguments.aberration:
        _stop_animation(scene.camera.data, f"aplanat.{name}")
        setattr(scene.camera.data.aplanat, name, strength)
    if arguments.breathing:
        _stop_animation(scene.camera.data, "aplanat.use_breathing")
        scene.camera.data.aplanat.use_breathing = True
    if arguments.distortion is not None:
        use_distortion(scene.camera.data, arguments.distortion)
    if arguments.highlights is not None:
        _use_highlights(scene.camera.data, arguments.highlights)
    if arguments.no_bokeh:
        _leave_out_bokeh(scene.camera.data)
    if arguments.no_chromatic:
        _leave_out_chromatic(scene.camera.data)
    if arguments.fstop or arguments.focus is not None:
        _use_lens_options(scene, arguments)
        _check_lens_options(scene, arguments)


def check_camera(scene):
    """Refuse a scene without a camera.

    Raises
    ------
    CameraError
    """
    if scene.camera is None:
        raise CameraError(f"scene '{scene.name}' has no camera; add one, or name one with --camera")


def use_engine(scene):
    """Choose Aplanat as the scene's render engine.

    Raises
    ------
    InputError
        If there is no view layer to render.
    """
    scene.render.engine = ENGINE_ID
    if not (scene.render.use_single_layer or any(layer.use for layer in scene.view_layers)):
        raise InputError(
            f"scene '{scene.name}': every view layer is switched off; switch one on (View Layer >"
            " Use for Rendering)"
        )


def check_size(scene):
    """Raise an error for pictures larger than this machine's memory.

    Raises
    ------
    InputError
    """
    render = scene.render
    width = render.resolution_x * render.resolution_percentage // 100
    height = render.resolution_y * render.resolution_percentage // 100
    memory = _physical_memory()
    needed = width * height * _BYTES_PER_PIXEL
    if memory and needed > memory:
        raise InputError(
            f"a picture of {width} x {height} pixels needs about {math.ceil(needed / 2**30)} GB of"
            f" memory and this machine has {memory // 2**30}; choose a smaller resolution"
        )


def use_camera(scene, name):
    """Look through a camera in all frames.

    Parameters
    ----------
    scene : bpy.types.Scene
    name : str
        Of the object.

    Raises
    ------
    CameraError
        If the scene has no such camera.
    """
    camera = scene.objects.get(name)
    if camera is None or camera.type != "CAMERA":
        names = ", ".join(sorted(f"'{o.name}'" for o in scene.objects if o.type == "CAMERA"))
        raise CameraError(
            f"--camera {name}: scene '{scene.name}' has no such camera; it has {names or 'none'}"
        )
    scene.camera = camera
    # A marker would switch to another camera at its frame.
    for marker in scene.timeline_markers:
        marker.camera = None


def find_lens(word):
    """Return the id of the lens that a command was asked for; a file is read into the library.

    Once a command, not in each frame: a file that is edited meanwhile must not change the lens in
    the middle of an animation.

    Parameters
    ----------
    word : str or None
        An id of the library, the path of a lens file, or None: none was asked for.

    Returns
    -------
    str or None

    Raises
    ------
    LensFileError
        If there is no such lens or it cannot be used.
    """
    if word is None:
        return None
    found = shelf().find(word)
    if found is None:
        return shelf().add_file(Library([user_folder()]).file_of(word))
    if found.error is not None:
        raise found.error
    return found.id


def use_lens(camera, lens_id, word):
    """Set a camera's lens.

    Parameters
    ----------
    camera : bpy.types.Object
    lens_id : str
        What `find_lens` returned.
    word : str
        What the user wrote, for the message.

    Raises
    ------
    CameraError
        If the camera takes none.
    """
    if camera.data.type != "PERSP":
        raise CameraError(
            f"--lens {word}: camera '{camera.name}' is {camera.data.type.lower()}; a lens needs a"
            " perspective camera (Camera > Lens > Type)"
        )
    camera.data.aplanat.lens = lens_id


def use_blades(data, count):
    """Set the number of blades of a camera's iris.

    Parameters
    ----------
    data : bpy.types.Camera
    count : int
        0 is round.
    """
    _stop_animation(data, "dof.aperture_blades")
    data.dof.aperture_blades = count


def use_distortion(data, wanted):
    """Set a camera's distortion.

    Parameters
    ----------
    data : bpy.types.Camera
    wanted : str or float
        "none", "lens" or K of the division model.
    """
    for name in settings_of(DISTORTION):
        _stop_animation(data, f"aplanat.{name}")
    if isinstance(wanted, float):
        data.aplanat.distortion, data.aplanat.distortion_k = "DIVISION", wanted
    else:
        data.aplanat.distortion = wanted.upper()


def _use_highlights(data, wanted):
    for name in ("highlights", "threshold"):
        _stop_animation(data, f"aplanat.bokeh.{name}")
    if wanted == "auto":
        data.aplanat.bokeh.highlights = "AUTO"
    else:
        # Setting it chooses it.
        data.aplanat.bokeh.threshold = wanted


def _leave_out_bokeh(data):
    _stop_animation(data, "aplanat.bokeh.use")
    data.aplanat.bokeh.use = False


def _leave_out_chromatic(data):
    _stop_animation(data, "aplanat.chromatic.use")
    data.aplanat.chromatic.use = False


def _use_lens_options(scene, arguments):
    data = scene.camera.data
    dof = data.dof
    dof.use_dof = True
    if arguments.fstop:
        _stop_animation(data, "dof.aperture_fstop")
        dof.aperture_fstop = arguments.fstop
    if isinstance(arguments.focus, float):
        _stop_animation(data, "dof.focus_distance")
        dof.focus_object = None
        dof.focus_distance = arguments.focus
    elif arguments.focus is not None:
        target = scene.objects.get(arguments.focus)
        if target is None:
            raise FocusError(
                f"--focus {arguments.focus}: scene '{scene.name}' has no object of this name;"
                " give a distance in m or the name of an object"
            )
        dof.focus_object = target
        dof.focus_subtarget = ""


def _check_lens_options(scene, arguments):
    camera = scene.camera.evaluated_get(bpy.context.evaluated_depsgraph_get())
    dof = camera.data.dof
    values = [(arguments.fstop, dof.aperture_fstop, "--fstop")]
    if isinstance(arguments.focus, float):
        values.append((arguments.focus, dof.focus_distance, "--focus"))
    for wanted, found, option in values:
        if wanted and not math.isclose(wanted, found, rel_tol=1e-5):
            raise InputError(
                f"{option} {wanted:g}: camera '{camera.name}' keeps {found:g}, which its animation"
                " or a driver sets; remove that from the file"
            )


def _stop_animation(data, path):
    animation = data.animation_data
    if animation is None:
        return
    curves = [*animation.drivers]
    if animation.action and animation.action_slot:
        for layer in animation.action.layers:
            for strip in layer.strips:
                bag = strip.channelbag(animation.action_slot)
                curves.extend(bag.fcurves if bag else ())
    for curve in curves:
        if curve.data_path == path:
            curve.mute = True


def _physical_memory():
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, OSError, ValueError):
        return 0
