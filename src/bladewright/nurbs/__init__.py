"""Floor 1: NURBS curves and surfaces of any dimension. Knows knots and control points, and no blades."""
