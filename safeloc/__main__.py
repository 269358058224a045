"""`python -m safeloc`: the command line, where the script is not on the path."""

from safeloc.cli import main

if __name__ == "__main__":
    main()
