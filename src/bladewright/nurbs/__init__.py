"""Floor 1: NURBS curves and surfaces of any degree and dimension. Knots and control points; nothing about blades.

`basis`, `curve`, `surface` and `trimmed` evaluate; `refine`, `domain`, `compatible` and `transform` change the
representation; `fit`, `skinning` and `revolution` construct; `closest`, `curvature`, `measure` and `mass_properties`
ask questions.
"""
