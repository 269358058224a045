"""The tests of the template, which a new project gets as they are."""
