"""Design files and what surrounds them: reading, writing, schema, built-in examples; see each module."""
