"""One picture by Cycles in a process of its own, so that its processor time is that of the picture.

    python -m benchmarks.referees.cycles_shot '{"file": "shot.blend", "size": [240, 135], ...}'

`cycles_shot` calls it and returns what it told.
"""

import json
import os
import resource
import subprocess
import sys
from pathlib import Path

_REPOSITORY = Path(__file__).resolve().parents[2]
_TOLD = "told:"


def cycles_shot(**wanted):
    """Render with Cycles in a new process.

    Parameters
    ----------
    file : str
        The .blend file.
    size : list of 2 int
    samples, seed : int
    denoise : bool
    focus, fstop : float, optional
        Of the camera, m; else its own.
    pinhole : bool, optional
        Without depth of field.
    output : str, optional
        An EXR file; without it nothing is rendered.
    save : str, optional
        A .blend file with these settings.

    Returns
    -------
    dict
        ``seconds`` of processor time of the render, ``focus`` and ``fstop`` in force.

    Raises
    ------
    RuntimeError
        If the process failed.
    """
    command = [sys.executable, "-P", "-m", "benchmarks.referees.cycles_shot", json.dumps(wanted)]
    environment = os.environ | {"PYTHONPATH": str(_REPOSITORY)}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    lines = [line for line in done.stdout.splitlines() if line.startswith(_TOLD)]
    if done.returncode or not lines:
        raise RuntimeError(f"Cycles failed: {done.stderr or done.stdout}")
    return json.loads(lines[0].removeprefix(_TOLD))


def main():
    """Render what the first word of the command line asks for, and print what it took."""
    import bpy

    wanted = json.loads(sys.argv[1])
    bpy.ops.wm.open_mainfile(filepath=wanted["file"])
    scene = bpy.context.scene
    render, dof = scene.render, scene.camera.data.dof
    render.engine = "CYCLES"
    render.resolution_x, render.resolution_y = wanted["size"]
    render.resolution_percentage = 100
    scene.cycles.samples, scene.cycles.seed = wanted["samples"], wanted["seed"]
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.use_denoising = wanted["denoise"]
    if "focus" in wanted:
        dof.use_dof, dof.focus_object = True, None
        dof.focus_distance, dof.aperture_fstop = wanted["focus"], wanted["fstop"]
    elif wanted.get("pinhole"):
        dof.use_dof = False
    if "save" in wanted:
        bpy.ops.wm.save_as_mainfile(filepath=wanted["save"])
    seconds = 0.0
    if "output" in wanted:
        settings = render.image_settings
        settings.media_type, settings.file_format = "IMAGE", "OPEN_EXR"
        settings.color_depth = "32"
        render.filepath, render.use_file_extension = wanted["output"], False
        seconds = -_processor_time()
        bpy.ops.render.render(write_still=True)
        seconds += _processor_time()
    told = {"seconds": seconds, "focus": dof.focus_distance, "fstop": dof.aperture_fstop}
    print(_TOLD + json.dumps(told))


def _processor_time():
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


if __name__ == "__main__":
    main()
