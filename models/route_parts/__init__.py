"""Parts of the route machine."""
