"""Files that are read whole, and the errors of those who decode them."""

from __future__ import annotations

import re
import stat
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from os import PathLike
from pathlib import Path

import numpy as np

from ibr_ref.scene.checks import LONGEST_MESSAGE, named, one_line

_MAX_BYTES = 2**32
"""Twice the samples of the largest 16-bit image: what is larger is a mistake, not an input."""
_OURS = re.compile(r"\bfound\b.*\b(allowed|needed)\b|\b(is|are) needed$|cannot be read \(|does not fit in memory")
"""How the errors of this package are worded."""


def contents(path: str | PathLike[str]) -> bytes:
    """All bytes of a file, at least one.

    Raises OSError or ValueError with the path for a name that does not exist or cannot be read, a folder, a device or
    pipe (which might never end), and a file that is empty or larger than 4 GiB.
    """
    path = Path(path)
    try:
        status = path.stat()
        if stat.S_ISREG(status.st_mode) and 0 < status.st_size <= _MAX_BYTES:
            return path.read_bytes()
    except OSError as error:
        raise type(error)(f"{named(path)}: cannot be read ({error.strerror})") from None
    except ValueError:  # a zero byte in the name
        raise ValueError(f"{named(path)}: found no file's name, allowed: one") from None
    if stat.S_ISDIR(status.st_mode):
        raise IsADirectoryError(f"{named(path)}: is a folder, a file is needed")
    if not stat.S_ISREG(status.st_mode):
        raise OSError(f"{named(path)}: is a device or a pipe, a file is needed")
    raise ValueError(f"{named(path)}: found {status.st_size} bytes, allowed: 1 to 2^32")


@contextmanager
def naming(path: str | PathLike[str]) -> Iterator[None]:
    """Around a decoder: whatever it raises comes out as a ValueError of one line that starts with the path.

    What a library says of bad data is for its own users, with their calls, versions and addresses, and can be as long as
    the data: it is replaced. Nor does any warning get out: what makes no numbers is refused, and said once. OSError where
    memory does not suffice.
    """
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            yield
    except MemoryError:
        raise OSError(f"{named(path)}: does not fit in memory") from None
    except Exception as error:  # bad data break the decoders of others in any way
        text = one_line(error, LONGEST_MESSAGE)
        if not (isinstance(error, (OSError, ValueError)) and _OURS.search(text)):
            text = "found what cannot be decoded, allowed: a file of this kind, whole and undamaged"
        raise ValueError(f"{named(path)}: {text}") from None
