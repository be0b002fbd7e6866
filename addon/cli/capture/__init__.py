"""`aplanat capture`."""
