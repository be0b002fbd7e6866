"""Small pictures of a lens, by which it is recognised: cross-section and bokeh."""

import numpy as np

from .cross_section import ON_BLACK, draw_cross_section

# Pixels on a side.
THUMBNAIL_SIZE = 256
_BACKGROUND = "#1b1d20"


def thumbnail(prescription, progress=None, cancelled=None):
    """Draw the cross-section of a lens with fans of rays.

    Parameters
    ----------
    prescription : Prescription
    progress : callable or None
        Told the share done, 0 to 1.
    cancelled : callable or None

    Returns
    -------
    ndarray of shape (THUMBNAIL_SIZE, THUMBNAIL_SIZE, 4)
        float32, display colours, first row at the top.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(2.56, 2.56), dpi=100, facecolor=_BACKGROUND)
    canvas = FigureCanvasAgg(figure)
    axes = figure.add_axes((0.02, 0.35, 0.96, 0.63))
    axes.set_axis_off()
    configuration = prescription.configuration()
    draw_cross_section(
        axes,
        configuration,
        fields_deg=(0.0, 0.7 * configuration.half_field_deg),
        palette=ON_BLACK,
    )
    canvas.draw()
    return np.asarray(canvas.buffer_rgba(), dtype=np.float32) / np.float32(255.0)
