"""Run the command line: python -m tiswarm."""

from tiswarm.cli import main

if __name__ == "__main__":
    main()
