"""What a declaration is and what it means: terms, machines, properties, the interpreter. Standard library only."""
