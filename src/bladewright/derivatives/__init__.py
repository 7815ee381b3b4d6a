"""Exact derivatives of what a design builds, forward and reverse, and what drives a design by them."""
