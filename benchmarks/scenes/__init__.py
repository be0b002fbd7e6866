"""Small scenes that tools and tests build, and their pictures."""
