"""Refocused pictures of a scene's frames, written file by file while others may work in between."""

import time
from contextlib import closing
from pathlib import Path

from ...device import context as device_context
from ...device import state
from ...device.textures import TextureCache
from ...errors import InputError
from ...files.frame_path import frame_path
from ...layers.captured_files import check_apart, load_captured
from ..frame.pacing import Pacer
from .live_picture import PIECE_SECONDS
from .pictures import save_picture
from .refocusing import Refocusing
from .scene_refocus import flat_options, layers_path, read_refocus


def write_frames(scene, frames, output, sources, depsgraph_of, note):
    """Write the refocused pictures of frames, a small piece of work with each step.

    Each file is whole or absent. A generator: whoever ends it before its time closes it. The scene
    is at the last frame that was begun then, unless only the present one was asked for.

    Parameters
    ----------
    scene : bpy.types.Scene
    frames : sequence of int
        If it is the present frame alone, values that were changed and not keyed count.
    output : Path
        Ends in .exr or .png; #### becomes the frame's number.
    sources : CameraSources
        Of the session.
    depsgraph_of : callable
        Returns the depsgraph of the scene's present frame.
    note : callable
        Takes each warning, a line.

    Yields
    ------
    frame : int
    share : float
        Of all that is to be done.

    Raises
    ------
    AplanatError
        If a picture cannot be made or written.
    """
    files = {frame: layers_path(scene, frame) for frame in frames}
    missing = [file for file in files.values() if not file.is_file()]
    if missing:
        raise InputError(
            f"captured file '{missing[0]}' does not exist"
            + (f" ({len(missing)} of {len(files)} frames are missing)" * (len(missing) > 1))
        )
    check_apart(files.values(), [Path(frame_path(output, frame)) for frame in frames])
    device_context.ensure_context()
    # Of the bokeh discs, which many frames have in common.
    looks = TextureCache()
    for number, (frame, file) in enumerate(files.items()):
        if frame != scene.frame_current:
            scene.frame_set(frame)
        yield frame, number / len(files)
        stack = load_captured(file, flat_options(scene))
        settings, problems = read_refocus(scene, depsgraph_of(), stack, sources)
        for line in (*stack.report, *problems):
            note(line)
        with closing(_pictures(stack, settings, looks, note)) as steps:
            for picture, share in steps:
                if picture is None:
                    yield frame, (number + share) / len(files)
        save_picture(Path(frame_path(output, frame)), picture, stack, scene)


def _pictures(stack, settings, looks, note):
    """Go through pieces of a picture; give it whole in the end."""
    refocusing, pacer = Refocusing(stack, settings, looks), Pacer(PIECE_SECONDS)
    try:
        while not refocusing.finished:
            yield None, refocusing.samples_done / settings.samples
            start, before = time.perf_counter(), refocusing.samples_done
            with state.preserved():
                refocusing.advance(pacer.samples)
            pacer.measured(refocusing.samples_done - before, time.perf_counter() - start)
        for line in refocusing.report:
            note(line)
        with state.preserved():
            picture = refocusing.read()
    finally:
        refocusing.release()
    yield picture, 1.0
