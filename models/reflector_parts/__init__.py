"""What the reflector machine is made of: map data, echoes, dead reckoning, balise readings, one cycle."""
