"""What is shown of a declaration: provers, drawn runs, the checker of proofs, and what is kept of earlier runs."""
