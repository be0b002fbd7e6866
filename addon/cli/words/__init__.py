"""Shared by all commands: option values, parser, console, tables, JSON."""
