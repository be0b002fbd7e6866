"""Passes that find, merge and splat highlights (methods 9, 13)."""
