"""Words in and text out: what every command shares."""
