"""The bokeh of a lens: tables of its traced light, and the look of its discs; pure numpy."""
