"""What a frame needs, as values: the snapshot, and its extraction from Blender."""
