"""Random scenes as recipes, and as scripts that build them."""
