"""From which places on the lens a highlight is seen (methods 10, 11)."""
