"""Turns of lights, places on them and directions of the sky; plain numpy."""
