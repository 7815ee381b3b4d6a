"""Floor 2: one blade section in its plane. Camber, thickness and edges; nothing about the third dimension."""
