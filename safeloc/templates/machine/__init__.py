"""Template: one machine with the error law of a sensor, the true position as a ghost, and containment as a claim."""
