"""The program's start: `mfr-bench` and `python -m mfr_bench`."""

import sys


def main() -> None:
    """Run the command line; Ctrl-C while it is still being loaded ends in a line, as it does later."""
    try:
        from .cli import main as command
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        sys.exit(130)
    command()


if __name__ == "__main__":
    main()
