"""Explains one property in words: what it says and assumes, how it was decided, and what to do about a run that violates it."""
