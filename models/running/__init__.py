"""A vehicle between references: the interval it is in, and the odometer that moves it."""
