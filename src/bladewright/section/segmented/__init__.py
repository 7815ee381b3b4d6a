"""The segmented airfoil: leading edge, central box and trailing edge of two cubic B-splines each, and its morphs."""
