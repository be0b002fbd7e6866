"""Benches of highlights."""
