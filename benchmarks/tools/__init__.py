"""Measuring tools that stand alone."""
