"""Campaigns: many simulated vehicles, drawn from declared distributions, and what can honestly be said of them."""
