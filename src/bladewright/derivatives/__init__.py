"""Floor 4: exact derivatives of whole designs by the complex step, forward and in reverse.

`complex_step` builds designs that carry a step; `sensitivity` differentiates any quantity of a build, `net_jacobian`
its control points and with them points of its surfaces, and `variables` presents a design to an optimiser. `step_study`
compares with central differences.
"""
