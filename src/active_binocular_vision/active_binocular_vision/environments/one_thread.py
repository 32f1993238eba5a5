"""One thread for BLAS: the coder's matrices are too small to share out, and threads wait busily."""

import threading
from contextlib import ContextDecorator
from functools import cached_property
from typing import Any

from threadpoolctl import ThreadpoolController


class OneThread(ContextDecorator):
    """Limits BLAS while code within is under way, in any thread; then it is as it was."""

    def __init__(self) -> None:
        """Begin outside."""
        self._lock, self._n_inside = threading.Lock(), 0

    @cached_property
    def _blas(self) -> ThreadpoolController:
        return ThreadpoolController().select(user_api="blas")

    def __enter__(self) -> None:
        """Limit BLAS, unless another thread is inside already."""
        with self._lock:
            if not self._n_inside:
                self._take_over()
                self._limit = self._blas.limit(limits=1)
            self._n_inside += 1

    def __exit__(self, *_: Any) -> None:
        """Let BLAS be as before, when the last thread leaves."""
        with self._lock:
            self._n_inside -= 1
            if not self._n_inside:
                self._take_over()
                self._limit.restore_original_limits()
                self._take_over()

    def _take_over(self) -> None:
        """Let any thread set it next; since threadpoolctl 3.8 it is for the last one to set it."""
        for library in self._blas.lib_controllers:
            if clear := getattr(library, "clear_controlling_thread", None):
                clear(force=True)
