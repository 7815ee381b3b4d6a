"""Floor 3: blades of sections in a flow path: designs, the exact blade, its native surfaces and its proof."""
