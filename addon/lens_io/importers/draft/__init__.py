"""Shared parts of all importers: text, glasses, options, and the draft of a lens."""
