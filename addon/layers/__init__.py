"""Pictures cut into depth layers, as values and as files: no Blender, no graphics device."""
