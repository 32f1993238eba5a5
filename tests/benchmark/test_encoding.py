"""The yardsticks of the encoding do the same work as what they measure."""

import numpy as np

from sparse_coder.coder import SparseCoder
from sparse_coder.config import SparseCoderConfig
from tests.benchmark.encoding import encoding_times_ms, plain_matching_pursuit


def _pictures(n: int) -> list[np.ndarray]:
    random = np.random.default_rng(3)
    return [random.integers(0, 256, (2, 128, 128)).astype(np.uint8) for _ in range(n)]


def test_plain_numpy_selects_as_the_coder_does() -> None:
    coder = SparseCoder(SparseCoderConfig(seed=1))
    encoding = coder.encode(*_pictures(1)[0])
    for patches, atoms, ours in zip(
        encoding.patches, coder.atoms(), encoding.selections, strict=True
    ):
        selected, coefficients = plain_matching_pursuit(patches, atoms, 10)
        assert (selected == ours.atoms).mean() > 0.999  # float32 sums in another order: near ties
        np.testing.assert_allclose(coefficients, ours.coefficients, atol=2e-5)


def test_plain_numpy_on_orthogonal_atoms_finds_the_largest_first() -> None:
    selected, coefficients = plain_matching_pursuit(
        np.array([[1.0, -3.0, 2.0]], np.float32), np.eye(3, dtype=np.float32), 2
    )
    assert selected.tolist() == [[1, 2]]
    assert coefficients.tolist() == [[-3.0, 2.0]]


def test_each_coder_has_a_time() -> None:
    times_ms = encoding_times_ms(SparseCoder(SparseCoderConfig(seed=1)), _pictures(2), 3)
    assert {"ours", "numpy"} <= set(times_ms) <= {"ours", "numpy", "sklearn"}
    assert all(time_ms > 0.0 for time_ms in times_ms.values())
