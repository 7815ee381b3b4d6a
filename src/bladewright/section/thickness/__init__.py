"""Thickness laws: half thicknesses along the chord from parameters along the span."""
