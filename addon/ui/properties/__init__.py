"""Property groups: the settings that are stored in Blender files."""
