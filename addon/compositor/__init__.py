"""Blender's compositor: node groups, the traced sprite as an image, and wiring of a scene."""
