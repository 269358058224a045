"""The stand-alone process."""
