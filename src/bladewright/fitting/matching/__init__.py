"""One structure matched to a cloud: distances, their derivatives, and least squares under inequalities."""
