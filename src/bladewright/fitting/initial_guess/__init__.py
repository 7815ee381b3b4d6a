"""A first design from points alone: near enough for a least-squares fit to converge from it."""
