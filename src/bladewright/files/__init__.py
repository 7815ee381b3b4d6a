"""Design files, their schema and examples, point clouds, SU2 surfaces, and the designs of other programs."""
