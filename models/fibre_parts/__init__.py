"""Parts of the fibre machine."""
