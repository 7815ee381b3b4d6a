"""Floor 0: arrays only. Elementary functions that carry complex numbers, roots, quadrature, linear solves."""
