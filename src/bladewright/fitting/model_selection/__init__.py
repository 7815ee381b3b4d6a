"""How many control points a design has: what a cloud asks for, predicted, added and taken away."""
