"""The process of a page that `embedded.view` starts: a pickled subject comes in, an address goes out.

It reads from its parent alone, which is trusted as any caller of a library is.
"""

import os
import pickle
import sys
import threading

from ibr_ref.viewer.server import Server
from ibr_ref.viewer.session import Session


def _end_with_the_parent() -> None:
    sys.stdin.buffer.read()
    os._exit(0)  # whatever is being drawn: nobody looks any more


if __name__ == "__main__":
    subject = pickle.load(sys.stdin.buffer)
    try:
        server = Server(Session(subject))
    except (ValueError, OSError) as error:
        sys.exit(print(error, flush=True))
    threading.Thread(target=_end_with_the_parent, daemon=True).start()
    print(server.address, flush=True)
    server.serve_forever()
