"""Importer of CODE V sequences."""
