"""What measures Aplanat: in a checkout only, and imported by nothing."""
