"""How much the state of eyes with twelve muscles shows of their three errors.

Takes the first observations of training episodes, which are drawn at random, and regresses the
errors on features of a run's dictionaries, pooled over each whole window as the learner gets them
or over its quadrants, and on the activations. Pictures of the regression and of its test differ.

usage: .venv/bin/python docs/examples/what_state_tells.py RUN [N_EPISODES] [JSON]

RUN: a run directory with a checkpoint, for example of profile twelve. Prints, for each error, the
share of its variance that is explained, and how often its sign is right.
"""

import json
import sys
from pathlib import Path

import numpy as np

from experiment_manager import make_loop, protocol_of
from experiment_manager.run import checkpoint
from experiment_manager.run.config_file import CONFIG_FILE, read_configuration
from lockstep import read_state
from sparse_coder.matching_pursuit import Selections, mean_squared_coefficients

ERRORS = ("horizontal", "vertical", "torsional")
# Of the pictures, the rest are for the test.
FITTED_SHARE = 0.8
RIDGES = 10.0 ** np.arange(-3.0, 4.0)


def quadrants(selections: Selections, n_bases: int) -> np.ndarray:
    """Return the features of each quadrant of a window, (4 n_bases,); a middle line is in two."""
    side = round(len(selections.atoms) ** 0.5)
    grid = np.arange(side**2).reshape(side, side)
    half = (side + 1) // 2
    parts = [
        grid[rows, columns].ravel()
        for rows in (slice(half), slice(-half, None))
        for columns in (slice(half), slice(-half, None))
    ]
    return np.concatenate(
        [
            mean_squared_coefficients(
                Selections(selections.atoms[part], selections.coefficients[part]), n_bases
            )
            for part in parts
        ]
    )


def observed(run: Path, n_episodes: int) -> tuple[dict[str, np.ndarray], np.ndarray, np.ndarray]:
    """Return entries of the state by name, errors in deg (n, 3), and numbers of pictures (n,)."""
    parameters = read_configuration(run / CONFIG_FILE)
    protocol = protocol_of(parameters)
    newest = checkpoint.newest(run / "checkpoints")
    if newest is None:
        sys.exit(f"error: {run}: expected a checkpoint")
    loop = make_loop(parameters)
    loop.coder.restore(read_state(newest[1] / "sparse_coder.npz", "sparse_coder"))
    n_bases = loop.coder.config.n_bases
    pooled, by_quadrant, felt, errors_deg, stimuli = [], [], [], [], []
    for _, episode in zip(range(n_episodes), protocol.training_episodes(), strict=False):
        seen = loop.plant.begin(episode)
        encoding = loop.coder.encode(*seen.pictures)
        pooled.append(encoding.features.ravel())
        by_quadrant.append(np.concatenate([quadrants(s, n_bases) for s in encoding.selections]))
        felt.append(seen.state.activations)
        error = seen.truth.gaze_error
        errors_deg.append((error.horizontal_deg, error.vertical_deg, error.torsional_deg))
        stimuli.append(episode.stimulus)
    loop.plant.close()
    # As the learner does (D15).
    exponent = parameters["vergence_rl"]["feature_exponent"]
    features, parts = np.array(pooled) ** exponent, np.array(by_quadrant) ** exponent
    activations = np.array(felt)
    entries = {
        "features of the whole window": features,
        "features by quadrant": parts,
        "activations": activations,
        "features and activations": np.hstack([features, activations]),
    }
    return entries, np.array(errors_deg), np.array(stimuli)


def predicted(entries: np.ndarray, errors: np.ndarray, is_fitted: np.ndarray) -> np.ndarray:
    """Return the errors that ridge regression predicts where they were not fitted, (n_test, 3).

    The penalty of each error is the best on a fifth of the fitted ones.
    """
    fitted = np.flatnonzero(is_fitted)
    mean, scale = entries[fitted].mean(0), entries[fitted].std(0)
    x = (entries - mean) / np.where(scale > 0, scale, 1.0)
    offset = errors[fitted].mean(0)
    inner, outer = fitted[len(fitted) // 5 :], fitted[: len(fitted) // 5]
    tried = [_ridge(x[inner], errors[inner] - offset, ridge) for ridge in RIDGES]
    missed = [((x[outer] @ w + offset - errors[outer]) ** 2).sum(0) for w in tried]
    best = RIDGES[np.argmin(missed, axis=0)]
    columns = [
        _ridge(x[fitted], errors[fitted, i : i + 1] - offset[i], ridge)[:, 0]
        for i, ridge in enumerate(best)
    ]
    return x[~is_fitted] @ np.array(columns).T + offset


def _ridge(x: np.ndarray, y: np.ndarray, ridge: float) -> np.ndarray:
    squares = x.T @ x
    return np.linalg.solve(squares + ridge * len(x) / 1000 * np.eye(len(squares)), x.T @ y)


def main() -> None:
    """Print a table, and write it where asked."""
    run = Path(sys.argv[1])
    n_episodes = int(sys.argv[2]) if len(sys.argv) > 2 else 6000
    entries, errors_deg, stimuli = observed(run, n_episodes)
    is_fitted = stimuli < np.quantile(stimuli, FITTED_SHARE)
    true_deg = errors_deg[~is_fitted]
    table = {}
    for name, of_name in entries.items():
        found_deg = predicted(of_name, errors_deg, is_fitted)
        left = ((found_deg - true_deg) ** 2).sum(0)
        explained = 1 - left / ((true_deg - true_deg.mean(0)) ** 2).sum(0)
        signs = (np.sign(found_deg) == np.sign(true_deg)).mean(0)
        table[name] = {
            error: {"explained": round(float(e), 3), "sign_right": round(float(s), 3)}
            for error, e, s in zip(ERRORS, explained, signs, strict=True)
        }
        cells = (
            f"{error} {e:6.2f} {s:5.0%}"
            for error, e, s in zip(ERRORS, explained, signs, strict=True)
        )
        print(f"{name:30}", *cells, sep="   ")
    if len(sys.argv) > 3:
        Path(sys.argv[3]).write_text(json.dumps(table, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
