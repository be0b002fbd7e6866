"""The catalogue of glasses."""
