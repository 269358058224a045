"""Wrong machines, made on purpose: what properties, proofs and recordings notice of them, and what they do not."""
