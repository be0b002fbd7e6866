"""Rays through a lens, and what bundles of them tell."""
