"""Template: a source of the localizer, with the law of its sensor; the localizer's contract holds its claims."""
