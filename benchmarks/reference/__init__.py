"""Numpy twins of the GPU passes: slow, plain, what tests compare with."""
