"""Real lenses: prescription, rays, first-order values, pupils, bokeh profiles; pure numpy."""
