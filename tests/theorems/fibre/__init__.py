"""The words that can be read from the sections of a line, whatever is read wrongly: no machine, but every case."""
