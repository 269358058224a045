"""The guard of a satellite receiver: it passes on only positions that agree with map and motion."""
