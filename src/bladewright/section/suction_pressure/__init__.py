"""Sections by their suction and their pressure side: B-splines between rounded edges (Voss et al. 2025, section 3)."""
