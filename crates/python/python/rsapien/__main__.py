"""The ``rsapien`` command: ``python -m rsapien`` or, once installed, ``rsapien``."""

import sys

from rsapien._rsapien import run_command


def main() -> int:
    """Runs the command with this process's arguments and returns its exit status."""
    return run_command(["rsapien", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
