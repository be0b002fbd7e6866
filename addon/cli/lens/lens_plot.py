"""`aplanat lens plot`: a lens' data sheet, or two lenses side by side, as picture or drawing."""

from importlib.util import find_spec

from ...errors import InputError
from ...files.whole_file import check_writable, removed_on_signals, whole_file
from .lens_bake import lens_profile
from .lens_command import open_lens, tell_warnings


def plot(arguments, console):
    """Carry out `aplanat lens plot`; parameters and result as `lens_command.lens`."""
    if find_spec("matplotlib") is None:
        raise InputError(
            "drawing needs the package matplotlib, which is missing; install Aplanat from its"
            " extension zip"
        )
    with removed_on_signals():
        check_writable(arguments.output)
        return _compared(arguments, console) if arguments.compare else _one(arguments, console)


def _one(arguments, console):
    read = open_lens(arguments.lens)
    tell_warnings(read, console)
    configuration = read.prescription.configuration(arguments.zoom)
    profile = None
    if configuration.of_revolution:
        profile = lens_profile(read, arguments, console)
    figure = _sheet(read.prescription, configuration, profile, console)
    _save(figure, arguments)
    console.say(f"{read.prescription.name}: {arguments.output}")
    return {
        "command": "lens plot",
        "name": read.prescription.name,
        "label": configuration.label,
        "files": [str(arguments.output)],
        "warnings": [found.as_json() for found in read.warnings],
    }


def _compared(arguments, console):
    from matplotlib.figure import Figure

    from ...plots.comparison import SHEET_INCHES, draw_comparison, own_state

    lenses = [open_lens(word) for word in arguments.compare]
    states, warnings = [], []
    if arguments.zoom and not any(arguments.zoom in read.prescription.labels for read in lenses):
        # Tells which positions there are.
        lenses[0].prescription.configuration(arguments.zoom)
    for read in lenses:
        tell_warnings(read, console)
        warnings.extend(found.as_json() for found in read.warnings)
        has_it = arguments.zoom in read.prescription.labels
        states.append(own_state(read.prescription, arguments.zoom if has_it else None))
    figure = Figure(figsize=SHEET_INCHES)
    draw_comparison(figure, states, lambda: console.progress("drawing the sheet"))
    _save(figure, arguments)
    names = [state.prescription.name for state in states]
    console.say(f"{names[0]} and {names[1]}: {arguments.output}")
    return {
        "command": "lens plot",
        "names": names,
        "labels": [state.configuration.label for state in states],
        "files": [str(arguments.output)],
        "warnings": warnings,
    }


def _sheet(prescription, configuration, profile, console):
    from matplotlib.figure import Figure

    from ...plots.data_sheet import SHEET_INCHES, draw_sheet

    figure = Figure(figsize=SHEET_INCHES)
    draw_sheet(
        figure, prescription, configuration, profile, lambda: console.progress("drawing the sheet")
    )
    return figure


def _save(figure, arguments):
    import matplotlib

    kind = arguments.output.suffix.lower().removeprefix(".")
    width, height = arguments.size
    inches = figure.get_size_inches()
    figure.set_size_inches(inches[1] * width / height, inches[1])
    # The same lens gives the same file: neither the time nor random names go into it.
    metadata = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}.get(kind)
    settings = {"svg.hashsalt": "aplanat", "svg.fonttype": "none"}
    with matplotlib.rc_context(settings), whole_file(arguments.output) as place:
        figure.savefig(place, format=kind, dpi=height / inches[1], metadata=metadata)
