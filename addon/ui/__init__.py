"""Properties, operators and panels."""
