"""Drawings of objects that several lens samples share."""
