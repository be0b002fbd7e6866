"""Depth layers of a scene, rendered by Cycles, EEVEE or our own engine."""
