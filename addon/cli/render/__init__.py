"""`aplanat render`."""
