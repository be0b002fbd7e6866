"""`aplanat refocus`: captured pictures seen through the lens again."""
