"""How many control points a design has: what a cloud asks for, foreseen, added and taken away."""
