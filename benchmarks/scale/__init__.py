"""What large scenes, long animations and worst cases cost."""
