"""Shader nodes compared with Cycles, and the page of the docs that tells how they agree."""
