"""Work in the background of the user interface."""
