"""Planning and drawing a frame; final render, viewport and the engine class that Blender calls."""
