"""The scene of one frame as frozen values: neither Blender nor the graphics device."""
