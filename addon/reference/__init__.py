"""Numpy twins of the GPU passes: slow, plain, and what the GPU tests compare with. Not shipped."""
