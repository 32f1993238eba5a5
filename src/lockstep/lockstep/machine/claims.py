"""Names that one process of this machine has at a time, gone with it however it ends."""

import errno
import socket
from contextlib import ExitStack


def claim(name: str) -> ExitStack | None:
    """Return what holds a name until it is closed; None where another one has it.

    It is in Linux' abstract namespace, and no file: everybody sees it who shares the ports. A
    sandbox without such names gives them to everybody.
    """
    with ExitStack() as holder:
        try:
            named = holder.enter_context(socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM))
            named.bind(f"\0active_binocular_vision/{name}")
        except OSError as error:
            if error.errno == errno.EADDRINUSE:
                return None
        return holder.pop_all()
