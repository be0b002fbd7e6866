"""Passes that draw and light surfaces."""
