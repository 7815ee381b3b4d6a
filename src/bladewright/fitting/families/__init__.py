"""Fits of the families that are one part: where each begins from sampled sections, and what may grow in it."""
