"""Documents for an assessor besides the proofs: traceability, assumptions, independence of claims, mutation, broken clauses."""
