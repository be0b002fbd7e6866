"""Openings of the iris: blades behind a round stop, or any grey picture."""
