"""A file of trained eyes: what a finished run is and measured, and its learners, below 2 MB.

Learners that it gives back do in a test what those of the run do, bit for bit. If they learn on,
they begin from sums that were rounded.
"""

import math
import re
from typing import Annotated, Literal

import msgspec
import numpy as np
import zstandard

from lockstep import InputError

_LEVEL = 19
# The largest sums of hindsight regression, which only learning reads: most of a file, rounded as
# correlations, in steps of so much, or as much wider ones as make the file small enough.
_ROUNDED, _STEP, _WIDER = "sum_squares", 1.0 / 32767, 1.5
_MOST_BYTES = 2_000_000

States = dict[str, dict[str, np.ndarray]]


class _Array(msgspec.Struct):
    """An array: bytes of the same weight together, of a symmetric one its upper triangle.

    kind: NumPy's of what is kept; restored: NumPy's of what it was. roots: of correlations, the
    square roots (n,) of the diagonal that they lack, float64; step: what they are counted in.
    """

    kind: Annotated[str, msgspec.Meta(pattern=r"^[<|][biuf]\d+$")]
    restored: Annotated[str, msgspec.Meta(pattern=r"^[<|][biuf]\d+$")]
    shape: tuple[int, ...]
    is_symmetric: bool
    data: bytes
    roots: bytes = b""
    step: float = _STEP


class EyesFile(msgspec.Struct):
    """What the file holds.

    configuration: the run's config.yaml; results: its results.json; iteration: training iterations
    before the checkpoint; states: of the learners, by node.
    """

    configuration: str
    results: bytes
    iteration: Annotated[int, msgspec.Meta(ge=0)]
    states: dict[str, dict[str, _Array]]
    version: Literal[1] = 1


def packed(configuration: str, results: bytes, iteration: int, states: States) -> bytes:
    """Return the file's bytes; the arguments are as in `EyesFile`."""
    data, step = b"", _STEP
    while not data or (len(data) > _MOST_BYTES and step < 1.0):
        kept = {
            node: {name: _kept(name, array, step) for name, array in state.items()}
            for node, state in states.items()
        }
        document = msgspec.msgpack.encode(EyesFile(configuration, results, iteration, kept))
        data = zstandard.ZstdCompressor(level=_LEVEL).compress(document)
        step *= _WIDER
    return data


def unpacked(data: bytes) -> tuple[EyesFile, States]:
    """Return what a file's bytes hold, and its states; InputError for other bytes."""
    try:
        document = zstandard.ZstdDecompressor().decompress(data)
        eyes = msgspec.msgpack.decode(document, type=EyesFile)
        states = {
            node: {name: _restored(array) for name, array in state.items()}
            for node, state in eyes.states.items()
        }
    except (zstandard.ZstdError, msgspec.DecodeError, ValueError) as error:
        raise InputError(f"expected a file of trained eyes: {error}") from error
    return eyes, states


def _kept(name: str, array: np.ndarray, step: float) -> _Array:
    is_symmetric = array.ndim == 2 and len(array) > 1 and np.array_equal(array, array.T)
    values = array[np.triu_indices(len(array))] if is_symmetric else np.ravel(array)
    roots = np.zeros(0)
    if name.endswith(_ROUNDED):
        values, roots = _correlations(values, step)
    kept = values.astype(values.dtype.newbyteorder("<"))
    by_weight = kept.view(np.uint8).reshape(-1, kept.itemsize).T
    return _Array(
        *(kept.dtype.str, array.dtype.str, array.shape, bool(is_symmetric)),
        by_weight.tobytes(),
        roots.tobytes(),
        step,
    )


def _correlations(upper: np.ndarray, step: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the correlations of an upper triangle (n (n + 1) / 2,) in steps, and roots (n,)."""
    rows, columns = np.triu_indices(math.isqrt(2 * len(upper)))
    roots = np.sqrt(upper[rows == columns])
    scale = roots[rows] * roots[columns]
    shares = np.divide(upper, scale, out=np.zeros(len(upper)), where=scale > 0.0)
    return np.rint(shares / step).astype("<i2"), roots


def _restored(array: _Array) -> np.ndarray:
    kind = np.dtype(array.kind)
    by_weight = np.frombuffer(array.data, np.uint8).reshape(kind.itemsize, -1)
    values = np.ascontiguousarray(by_weight.T).view(kind)[:, 0].astype(array.restored)
    if array.roots:
        roots = np.frombuffer(array.roots)
        rows, columns = np.triu_indices(len(roots))
        values *= array.step * roots[rows] * roots[columns]
    if not array.is_symmetric:
        return values.reshape(array.shape)
    whole = np.zeros(array.shape, values.dtype)
    upper = np.triu_indices(array.shape[0])
    whole[upper] = values
    whole.T[upper] = values
    return whole


def name_of_file(name: str) -> str:
    """Return the file's name for trained eyes; a profile's folder becomes a word of it.

    Raises InputError for a name that is none.
    """
    if not re.fullmatch(r"[\w-]+(/[\w-]+)?", name):
        raise InputError(f"expected a name such as those of profiles, got {name!r}")
    return f"{name.replace('/', '.')}.eyes"
