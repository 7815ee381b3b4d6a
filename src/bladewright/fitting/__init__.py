"""Fitting: from clouds of points to designs, and to plain curves and surfaces."""
