"""Backscatter from truth: trains, roads and wind shake a cable, light comes back from it; seeds are explicit."""
