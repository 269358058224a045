"""Proof cores: the clauses, lemmas and rows that a proof needs."""
