"""Satellite signals from truth: a sky, a train on its track, what stands beside it, a receiver; seeds are explicit."""
