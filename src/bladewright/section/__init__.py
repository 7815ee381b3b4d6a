"""Floor 2: one blade section in its plane. Knows camber, thickness and edges, and no third dimension."""
