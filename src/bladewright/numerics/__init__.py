"""Floor 0: arrays only. Elementary functions that carry a complex step, roots, quadrature, linear and least squares."""
