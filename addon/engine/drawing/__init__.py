"""The scene's buffers on the device, and drawing its surfaces for each lens sample."""
