"""Maps in other formats: each importer returns the line and notes on everything it did not carry over as it stands."""
