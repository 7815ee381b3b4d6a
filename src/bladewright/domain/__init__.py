"""Floor 4: what the fluid fills around a blade, in two and in three dimensions."""
