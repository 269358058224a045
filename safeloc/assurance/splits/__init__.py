"""Case splits that a configuration folds away, and the configurations that make every one of them live."""
