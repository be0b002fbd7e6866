"""What can be set: one declaration a setting."""
