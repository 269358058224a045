"""The digital map: what lies along a line, where routes lead, and whether the layout meets what the proofs assume."""
