"""What a process is for, imported without delay: python -m lockstep.machine.start MODULE ARGUMENTS.

That is python -m MODULE, for a module with a `main`, which begins and ends in 0.6 times the time.
"""

import gc
import sys
from importlib import import_module
from types import ModuleType
from typing import Any


def imported(module: str) -> ModuleType:
    """Import what the process will be busy with until it ends; return the module.

    Meanwhile nobody looks for garbage among the many objects of NumPy, numba and ROS: there is
    none, and later they are left out. And coverage, which numba asks for and nobody here measures,
    is kept from being imported.
    """
    modules: dict[str, Any] = sys.modules
    modules.setdefault("coverage", None)
    gc.disable()
    try:
        return import_module(module)
    finally:
        gc.freeze()
        gc.enable()


if __name__ == "__main__":
    imported(sys.argv.pop(1)).main()
