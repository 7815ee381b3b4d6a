"""Native blades: NURBS surfaces that interpolate an exact blade, and what is measured on them."""
