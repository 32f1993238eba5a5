"""Files as memory: read where they are looked at, and shared by all processes that look.

By the C library, since Python's mmap keeps a descriptor for each file until 3.13, which has
`trackfd`: a thousand files would take all that a process usually may have. Privately, since FUSE
and 9p may refuse shared mappings; nobody writes, so the memory is shared all the same.
"""

import ctypes
import mmap
import os
from typing import BinaryIO

import numpy as np

_LIBC = ctypes.CDLL(None, use_errno=True)
_LIBC.mmap.restype = ctypes.c_void_p
_LIBC.mmap.argtypes = [ctypes.c_void_p, ctypes.c_size_t, *[ctypes.c_int] * 3, ctypes.c_long]
_LIBC.munmap.argtypes = [ctypes.c_void_p, ctypes.c_size_t]
_FAILED = ctypes.c_void_p(-1).value


class _Mapping:
    """A mapped file, which arrays hold on to by NumPy's array interface."""

    def __init__(self, file: BinaryIO, n_bytes: int) -> None:
        self._n_bytes = n_bytes
        self._address = _LIBC.mmap(
            None, n_bytes, mmap.PROT_READ, mmap.MAP_PRIVATE, file.fileno(), 0
        )
        if self._address == _FAILED:
            self._n_bytes = 0
            raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))
        read_only = True
        self.__array_interface__ = {
            "version": 3,
            "data": (self._address, read_only),
            "shape": (n_bytes,),
            "typestr": "|u1",
        }

    def __del__(self) -> None:
        if self._n_bytes:
            _LIBC.munmap(self._address, self._n_bytes)


def map_bytes(file: BinaryIO) -> np.ndarray:
    """Return all bytes of an open file, (n_bytes,) uint8, read only; the file may then be closed.

    They are read at once where its file system maps nothing.
    """
    n_bytes = os.fstat(file.fileno()).st_size
    try:
        return np.asarray(_Mapping(file, n_bytes))
    except OSError:
        file.seek(0)
        return np.frombuffer(file.read(), np.uint8)
