"""Clouds as they come: what can be fitted, repeated blades, fewer points, isolated points."""
