"""What was found, as data, pages and pictures."""
