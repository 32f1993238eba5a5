import numpy as np

from vergence_rl.gaze.fading_regression import FadingRegression


def learned(n: int) -> FadingRegression:
    draw = np.random.default_rng(1)
    regression = FadingRegression(3, (), ridge_share=0.1, counted="n_seen")
    for x in draw.normal(size=(n, 3)):
        regression.add(x, draw.normal(), kept=0.8)
    return regression


def test_goes_on_from_its_state_bit_for_bit_and_shares_no_memory_with_it() -> None:
    whole, part = learned(9), learned(4)
    part.weights()  # to be forgotten
    state = whole.state()
    part.restore(state)
    assert part.weights().tobytes() == whole.weights().tobytes()
    for array in state.values():
        array[...] = 7
    for regression in (whole, part):
        regression.add(np.ones(3), 2.0, kept=0.9)
    assert part.weights().tobytes() == whole.weights().tobytes()
    assert part.state()["n_seen"] == whole.n_learned == 10
