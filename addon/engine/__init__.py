"""Planning and rendering a frame."""
