"""Fibre sensing: from backscatter along a track to trains, sections and test patterns, in whole numbers with bounds."""
