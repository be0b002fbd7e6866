"""Every exception class of the extension.

A message says what is wrong, where, and what to do. Callers at the rim (engine, operators, command
line) catch `AplanatError` only and show the message in one line.
"""


class AplanatError(Exception):
    """Base of all errors that Aplanat raises on purpose."""


class InputError(AplanatError, ValueError):
    """A file, an option or a setting that cannot be used. The command line exits with 2."""


class FocusError(InputError):
    """A focus distance, f-number or iris with which no picture can be formed."""


class CameraError(InputError):
    """A camera that is missing or of a kind that the engine does not render."""


class PrescriptionError(InputError):
    """A lens prescription, or a setting of one, with which no rays can be traced."""


class LensFileError(InputError):
    """A lens file that cannot be loaded: everything that is wrong with it, and the warnings.

    Parameters
    ----------
    file_name : str
    findings : sequence
        Errors, each with ``code``, ``path`` and ``message`` (see `addon.lens_io.toml.findings`).
    warnings : sequence
        Warnings of the same kind.
    """

    def __init__(self, file_name, findings, warnings=()):
        first = findings[0]
        where = f"{first.path}: " if first.path else ""
        more = f" (and {len(findings) - 1} more)" if len(findings) > 1 else ""
        super().__init__(f"{file_name}: {first.code} {where}{first.message}{more}")
        self.file_name = file_name
        self.findings = tuple(findings)
        self.warnings = tuple(warnings)


class GlassNotFoundError(InputError, LookupError):
    """A glass name that the catalogue does not have."""


class OutputError(InputError):
    """A picture that cannot be written where it was asked for."""


class UnfinishedFileError(OutputError):
    """A file that could be begun and not finished, as on a full disk. Exit code 1."""


class StrictError(InputError):
    """Raised by --strict when a render has warnings.

    Parameters
    ----------
    warnings : sequence of str
    """

    def __init__(self, warnings):
        self.warnings = tuple(warnings)
        count = len(self.warnings)
        counted = "a warning" if count == 1 else f"{count} warnings, the first of them"
        super().__init__(
            f"--strict: nothing is written because of {counted}: {self.warnings[0]}; mend it, or"
            " leave out --strict"
        )


class DeviceUnavailableError(AplanatError):
    """There is no GPU context to draw with."""


class DeviceLimitError(AplanatError):
    """Something larger than the graphics device can hold.

    Parameters
    ----------
    limit : str
        The limit in words, with its value.
    needed : str
        What was needed, in words, and what to do.
    """

    def __init__(self, limit, needed):
        super().__init__(f"{needed}; this graphics device allows {limit}")
        self.limit = limit
        self.needed = needed


class ShaderResourceError(AplanatError):
    """A shader and the values given to it do not fit: a defect of Aplanat, not of a scene.

    Parameters
    ----------
    pass_name : str
        The pass that was being drawn.
    names : sequence of str
        The push constants, blocks, samplers or images.
    what : str
        What is wrong with them.
    """

    def __init__(self, pass_name, names, what):
        super().__init__(
            f"shader of pass '{pass_name}': {', '.join(names)}: {what}; please report this scene"
        )
        self.pass_name = pass_name
        self.names = tuple(names)


class ShaderCompileError(AplanatError):
    """A shader that the driver refused.

    Parameters
    ----------
    pass_name : str
        The pass or variant that was being compiled.
    log : str
        The compiler's log with `file:line` locations.
    """

    def __init__(self, pass_name, log):
        super().__init__(f"shader of pass '{pass_name}' did not compile: {log}")
        self.pass_name = pass_name
        self.log = log


class RenderCancelledError(AplanatError):
    """The user stopped the render."""
