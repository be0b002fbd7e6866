"""The look of out-of-focus points: profiles of traced lenses, and what an artist adds to them."""
