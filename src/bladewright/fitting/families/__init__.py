"""Fits of each family: where it begins, and what may grow in it."""
