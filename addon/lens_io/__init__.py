"""Lens files: readers, writer, importers, the library of lenses, profiles on disk."""
