"""Draw an exported case in GLSL: `python -m ibr_ref.ports CASE PORT`, two folders.

CASE is what `ibr-ref export` wrote; PORT receives what the port has drawn, for `ibr-ref check CASE PORT`. `ibr-ref draw` has
the other sample ports.
"""

from __future__ import annotations

import sys
from pathlib import Path

from ibr_ref.ports.drawing import SAMPLES


def main() -> None:
    """Read, draw, write."""
    if len(sys.argv) != 3:
        sys.exit("usage: python -m ibr_ref.ports CASE PORT")
    try:
        SAMPLES["glsl"](None).into(Path(sys.argv[1]), Path(sys.argv[2]))
    except ValueError as error:
        sys.exit(str(error))


if __name__ == "__main__":
    main()
