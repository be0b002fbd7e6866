"""Benches of `aplanat bench`."""
