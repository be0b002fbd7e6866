"""Lens samples of a real lens: where each draws a point, and how much of its light it lets by."""
