"""A scene on the device, and drawing it for one lens sample after another."""
