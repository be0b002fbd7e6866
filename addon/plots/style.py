"""Style of the plots: colours of lines, wavelengths and fields, frames of diagrams."""

from dataclasses import dataclass

INK, QUIET, RULE = "#222a31", "#6d7a86", "#dfe5ea"
FACE = "#fbfcfd"
# Wavelengths by their Fraunhofer lines, in nm, and colours that tell them apart on paper.
SPECTRUM = ((656.2725, "C", "#c23b2e"), (587.5618, "d", "#d79b12"), (486.1327, "F", "#2a72b5"))
VIOLET = (440.0, "440 nm", "#7b46a3")
TITLE_SIZE, TEXT_SIZE, SMALL_SIZE = 10.0, 8.5, 7.5


@dataclass(frozen=True)
class Panel:
    """A place on a sheet, in shares of its width and height, from the lower left.

    Parameters
    ----------
    x, y, width, height : float
    """

    x: float
    y: float
    width: float
    height: float

    def axes(self, figure):
        """Add axes that fill the panel."""
        return figure.add_axes((self.x, self.y, self.width, self.height))

    def column(self, number, count, gap=0.0):
        """Return one of `count` equal columns with gaps in shares of the sheet."""
        width = (self.width - gap * (count - 1)) / count
        return Panel(self.x + number * (width + gap), self.y, width, self.height)


def frame_diagram(axes, title, x_label="", y_label=""):
    """Give axes of a diagram title, labels and quiet lines."""
    axes.set_title(title, loc="left", fontsize=TITLE_SIZE, color=INK, pad=7.0, weight="bold")
    axes.set_xlabel(x_label, fontsize=TEXT_SIZE, color=QUIET, labelpad=3.0)
    axes.set_ylabel(y_label, fontsize=TEXT_SIZE, color=QUIET, labelpad=3.0)
    axes.set_facecolor(FACE)
    axes.grid(True, color=RULE, linewidth=0.7)
    axes.set_axisbelow(True)
    axes.tick_params(labelsize=SMALL_SIZE, colors=QUIET, length=2.5, width=0.6)
    axes.locator_params(nbins=6)
    for side, spine in axes.spines.items():
        spine.set_visible(side in ("left", "bottom"))
        spine.set_color(QUIET)
        spine.set_linewidth(0.7)


def frame_picture(axes, title=""):
    """Give axes of a small picture a thin frame and no scales."""
    axes.set_xticks([])
    axes.set_yticks([])
    for spine in axes.spines.values():
        spine.set_color(RULE)
        spine.set_linewidth(0.8)
    if title:
        axes.set_title(title, fontsize=TEXT_SIZE, color=QUIET, pad=4.0)


def legend(axes, **options):
    """Add a legend without a frame."""
    axes.legend(fontsize=SMALL_SIZE, frameon=False, labelcolor=INK, handlelength=1.6, **options)


def symmetric_limits(values, least):
    """Return limits around 0 that hold all values, at least `least` on each side."""
    reach = max([least, *(abs(float(value)) for value in values)])
    return -1.08 * reach, 1.08 * reach


def length(mm):
    """Return a length in the unit that suits it, as text."""
    return f"{mm:.3g} mm" if mm >= 0.1 else f"{1000.0 * mm:.3g} µm"
