"""Parts of the line-area machine."""
