"""Importer of Zemax files."""
