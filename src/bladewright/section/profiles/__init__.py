"""Standard profiles, each one a mean line with a thickness form on it or a few arcs: one file a kind."""
