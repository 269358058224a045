"""Parts of the verification machine."""
