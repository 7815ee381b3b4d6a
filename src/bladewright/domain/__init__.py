"""Floor 4: the flow domain around a blade, in two and in three dimensions, and the metal that carries blades.

`build` leads from a blade to its passage: `duct` continues the channel and `camber_lines` the camber lines, `walls` are
exact patches of hub and shroud in their plane, `knot_selection` decides what is held, `nets` interpolates, and
`passage` is the result; `extents` and `checks` refuse what cannot be. `periodic_sector` is fluid and blade together,
and `section` the flow domain of a 2D section. `skin` is what passage, sector and wheel share; `disc` places an outline
on a wall, `carried_pitch` is one pitch of that wall, `cyclic_faces` close a `sector`, and `wheel` is all of them.
"""
