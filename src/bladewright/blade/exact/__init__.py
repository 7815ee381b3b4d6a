"""Exact blades: sections on their stream surfaces at any place along the span, which native surfaces interpolate."""
