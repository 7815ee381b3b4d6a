"""How good a match is: deviations, intervals, what the cloud does not show, and whether it passes."""
