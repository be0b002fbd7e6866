"""The bokeh of a lens: what its discs look like."""
