"""Tables of a real lens: where the light of a point goes, traced once."""
