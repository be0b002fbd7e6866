"""Passes of the layered method: layers with their pyramids, and rays through them (methods 7)."""
