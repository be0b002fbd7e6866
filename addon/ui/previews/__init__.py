"""Pictures in panels."""
