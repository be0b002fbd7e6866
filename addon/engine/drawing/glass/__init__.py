"""Glass: what a lens sample sees through it."""
