"""Controllers embedded in a host."""
