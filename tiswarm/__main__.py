"""Run the command line: python -m tiswarm, and the command tiswarm."""

import sys

from tiswarm.system.progress import INTERRUPTED, listen_for_interrupts


def main() -> None:
    """Listen for Ctrl-C before anything else, then run."""
    try:
        listen_for_interrupts()
        from tiswarm.cli import main as run

        run()
    except KeyboardInterrupt:
        sys.exit(INTERRUPTED)


if __name__ == "__main__":
    main()
