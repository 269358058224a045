"""Random edits of machines and of the engine, each verified with what earlier runs left and without: the same verdicts."""
