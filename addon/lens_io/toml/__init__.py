"""Aplanat's own lens files: reader, checks, writer."""
