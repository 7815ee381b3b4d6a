"""Blades as designs: frozen records of engineering parameters, in the design's own length unit and in degrees."""
