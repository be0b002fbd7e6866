"""What is decided before a frame is drawn: samples, wavelengths, highlights, quality."""
