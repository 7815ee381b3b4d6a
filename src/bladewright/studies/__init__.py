"""Many designs at a time: sweeps over variables, and searches; each run is one line of a manifest."""
