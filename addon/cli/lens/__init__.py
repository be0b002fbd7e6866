"""`aplanat lens`."""
