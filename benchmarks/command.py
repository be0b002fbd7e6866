"""`aplanat bench`: which bench its words ask for."""

from addon import register
from addon.cli import command

from .arguments import parse


def main(words, program="aplanat"):
    """Run a bench in a Blender where Aplanat is registered.

    Returns
    -------
    int
        The exit code.
    """
    return command.main(words, program, parse, runner)


def run_process():
    """Run the bench of `sys.argv` as this process, and end it."""
    command.run_process(register, parse, runner)


def runner(arguments, prepare):
    """Return what carries out a bench; ``prepare`` registers Aplanat where the bench needs it."""
    if arguments.lens:
        from .benches.lens import bench_lenses as run

        return run
    prepare()
    if arguments.chromatic:
        from .benches.chromatic import bench_chromatic as run
    elif arguments.bokeh is not None:
        from .bokeh.bench import bench_bokeh as run
    elif arguments.method == "adaptive":
        from .benches.adaptive import bench_adaptive as run
    else:
        from .benches.reference_method import bench as run
    return run
