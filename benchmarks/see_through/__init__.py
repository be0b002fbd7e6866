"""Depth of field through and around transparent things, against Cycles."""
