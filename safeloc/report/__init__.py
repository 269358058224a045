"""Reports of findings: data, pages and pictures."""
