"""What is stored in Blender files."""
