"""Drawing a frame: its GPU passes in order, the sums of its samples, its pictures."""
