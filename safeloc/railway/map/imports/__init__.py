"""Importers of maps in other formats. Each returns the line, and notes on everything dropped, changed or assumed."""
