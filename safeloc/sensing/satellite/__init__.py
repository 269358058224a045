"""Satellite front end: broadcast orbits, predicted and measured values, clock removal, position along the track."""
