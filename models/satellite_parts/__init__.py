"""Parts of the satellite machines."""
