"""Proof cores (minimal sets of clauses, lemmas and rows), and the effects of clauses broken alone and in pairs."""
