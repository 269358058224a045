"""Documents for an assessor besides the proofs, such as requirements traced in both directions."""
