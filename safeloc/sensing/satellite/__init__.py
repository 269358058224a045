"""Satellite front end: orbits from ephemerides, predicted and measured values, clock removal, position along the track."""
