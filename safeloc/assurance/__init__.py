"""What an assessor asks for beside the proofs: the requirements, traced both ways."""
