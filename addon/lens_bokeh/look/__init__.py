"""The look of a disc: iris, grain, diffraction, vignetting, and the disc as a picture."""
