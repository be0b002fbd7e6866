"""Real lenses: prescription, glass, first-order values; ray tracing in `rays`. Pure numpy."""
