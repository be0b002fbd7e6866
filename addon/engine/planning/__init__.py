"""Planning of a frame before it is drawn: samples, wavelengths, highlights, quality."""
