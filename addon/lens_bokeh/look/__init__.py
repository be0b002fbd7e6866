"""What an artist adds to a disc, and the disc as pictures."""
