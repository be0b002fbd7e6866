"""What all importers share: text, glasses, options, and the draft of a lens."""
