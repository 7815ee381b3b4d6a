"""Plain curves, surfaces and profiles fitted to points."""
