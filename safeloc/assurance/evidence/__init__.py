"""What the proofs of a target rest on: minimal sets of clauses, lemmas and rows, and every clause broken alone or in pairs."""
