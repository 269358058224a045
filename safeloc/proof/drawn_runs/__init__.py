"""Random runs of any machine: segments where a condition holds, admissible inputs, input profiles, and complete runs."""
