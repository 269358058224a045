"""The digital map of a line: its elements, its routes, and checks of its consistency."""
