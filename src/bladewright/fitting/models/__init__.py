"""Kinds of designs as a search sees them: their sides, the derivatives of these, and what is refused."""
