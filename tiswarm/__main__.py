"""Run the command line: python -m tiswarm, and the command tiswarm."""

import signal

if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # until somebody listens, Ctrl-C ends the process without a word

import os
import sys


def main() -> None:
    """Open the standard streams that are closed, listen for Ctrl-C before anything else, then run."""
    told = _opened()
    from tiswarm.system.progress import INTERRUPTED, listen_for_interrupts

    try:
        listen_for_interrupts()
        if told:
            sys.stderr.write(f"tiswarm: {told}\n")
            sys.exit(1)
        from tiswarm.cli import main as run

        run()
    except KeyboardInterrupt:
        sys.exit(INTERRUPTED)


def _opened() -> str:
    """Open closed standard streams, lest a file that is written becomes one of them; say so where results would be lost."""
    closed = [number for number in range(3) if not _is_open(number)]
    for number in closed:  # the lowest free number is the one that is given
        os.open(os.devnull, os.O_RDONLY if number == 0 else os.O_WRONLY)
    if sys.stderr is None:
        sys.stderr = open(2, "w", encoding="utf-8", closefd=False)  # noqa: SIM115 - it stays open
    return "standard output is closed; send it to a file, or to /dev/null" if 1 in closed else ""


def _is_open(number: int) -> bool:
    try:
        os.fstat(number)
    except OSError:
        return False
    return True


if __name__ == "__main__":
    main()
