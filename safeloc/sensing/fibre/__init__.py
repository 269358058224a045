"""Fibre front end: finds trains, sections and test patterns in backscatter, in whole numbers with bounds."""
