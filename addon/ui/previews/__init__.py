"""Preview pictures in panels."""
