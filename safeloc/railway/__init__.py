"""Railway parts: the map, the audit of its layout, the guard of a receiver, pictures of runs."""
