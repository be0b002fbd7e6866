"""Frames that are drawn through depth layers (methods 7)."""
