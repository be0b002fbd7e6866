"""The bokeh of a frame: highlights found, merged and splatted (methods 9, 12, 13)."""
