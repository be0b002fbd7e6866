"""Tables of a traced lens: bokeh profile of axial points, and the pupil over the field."""
