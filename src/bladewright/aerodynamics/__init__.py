"""What air does around a lone section: polars, by solvers that only this room knows."""
