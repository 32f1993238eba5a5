"""What a run keeps of its trials: small, and enough for what is drawn of it."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from msgspec.structs import asdict

from experiment_manager import Trials
from experiment_manager.measures import metrics
from experiment_manager.measures.criteria import criteria_of
from experiment_manager.measures.kept_trials import (
    KEPT_FILE,
    KeptTrials,
    arrays_of,
    from_arrays,
    with_test,
    write_trials,
)
from experiment_manager.measures.results import Measures, Summary
from eye_plant.config import EyePlantConfig
from lockstep.command_space import COMMAND_SPACES
from lockstep.errors import InputError
from tests.kept_tests import kept_tests
from tests.pair import COMMAND_NAMES, PAIR_SPACE

N_TRIALS, N = 12, 20


def summary_of(trials: Trials) -> Summary:
    return metrics.summary_of(trials, criteria_of(EyePlantConfig()))


def _test(training_iteration: int, n_trials: int = N_TRIALS, eyes: int = 0) -> Trials:
    """Trials of four stimuli that begin alike in every test of the same eyes; then they differ."""
    draw, start = np.random.default_rng(training_iteration), np.random.default_rng(eyes)
    error_deg, rate_w = draw.normal(size=(2, n_trials, N + 1))
    activations = draw.random((n_trials, N + 1, 2)) / 10
    error_deg[:, 0], rate_w[:, 0] = start.normal(size=(2, n_trials))
    error_deg[:, 0] = np.round(2.0 * error_deg[:, 0])
    of_trial = {
        "stimulus": 100.0 + np.arange(n_trials) // 3,
        "object_distance_m": start.choice([0.5, 3.0, 6.0], n_trials),
        "optimal_metabolic_rate_w": start.random(n_trials),
    }
    columns = {name: np.repeat(v[:, None], N + 1, axis=1) for name, v in of_trial.items()}
    columns |= {"vergence_error_deg": error_deg, "metabolic_rate_w": rate_w}
    columns |= {name: activations[..., i] for i, name in enumerate(COMMAND_NAMES)}
    rows = np.zeros((n_trials, N + 1), dtype=int)
    return Trials(PAIR_SPACE, training_iteration, np.arange(n_trials), columns, rows)


def _kept(*tests: Trials) -> KeptTrials:
    kept = None
    for test in tests:
        kept = with_test(kept, test)
    assert kept is not None
    return kept


def test_the_last_test_has_its_measures_and_the_others_their_ends(tmp_path: Path) -> None:
    tests = [_test(at) for at in (0, 500, 1000)]
    write_trials(tmp_path, _kept(*tests))
    found = kept_tests(tmp_path)
    assert [test.training_iteration for test in found] == [0, 500, 1000]

    for whole_set, kept_set in zip(_sets(tests[-1]), _sets(found[-1]), strict=True):
        assert kept_set == pytest.approx(whole_set, rel=1e-5)
    for before, after in zip(tests, found, strict=True):
        for k in (0, N):
            for name in ("vergence_error_deg", "metabolic_rate_w"):
                kept, whole = getattr(after, name)[:, k], getattr(before, name)[:, k]
                assert np.allclose(kept, whole, rtol=1e-6)
        assert np.allclose(after.cost_reduction(N), before.cost_reduction(N), rtol=1e-4)
    after_2 = summary_of(found[0]).after[2]
    assert set(asdict(after_2).values()) == {None}, "not kept of an earlier test"


def _sets(trials: Trials) -> list[dict[str, float | None]]:
    """Return the measures of all trials and of fewer, after all iterations that are reported."""
    test = summary_of(trials)
    sets = (test, test.without_zero_start_error, test.starts_up_to_2_deg)
    measures = [measures for of_set in sets for measures in (of_set, *of_set.after.values())]
    names = Measures.__struct_fields__
    values = [{name: getattr(after, name) for name in names} for after in measures]
    # Of the pair's tests there are no others.
    return [{n: v for n, v in of_set.items() if v is not None} for of_set in values]


def test_tests_of_other_eyes_have_their_own_starts_and_optima(tmp_path: Path) -> None:
    tests = [_test(0, eyes=1), _test(500, eyes=1), _test(600, eyes=2), _test(1000, eyes=2)]
    distance_m = {"object_distance_m": tests[0].column("object_distance_m")}
    tests = [replace(test, columns={**test.columns, **distance_m}) for test in tests]
    for n_tests in (2, 3, 4):
        write_trials(tmp_path, _kept(*tests[:n_tests]))
        found = kept_tests(tmp_path)
        assert len(found) == n_tests
        for before, after in zip(tests, found, strict=False):
            kept, whole = summary_of(after), summary_of(before)
            for name in ("median_delta_cost_w", "median_cost_reduction"):
                assert getattr(kept, name) == pytest.approx(getattr(whole, name), rel=1e-4)
            starts_deg = before.vergence_error_deg[:, 0]
            assert np.allclose(after.vergence_error_deg[:, 0], starts_deg, rtol=1e-6)
    assert _kept(*tests).began_otherwise.tolist() == [0, 1]


def test_what_was_kept_when_optima_did_not_depend_on_targets_is_read() -> None:
    arrays = arrays_of(_kept(_test(0), _test(500)))
    old = from_arrays({**arrays, "optimal_rate_w": arrays["optimal_rate_w"][:, 0]})
    assert old is not None
    assert np.array_equal(old.optimal_rate_w, arrays["optimal_rate_w"])


def test_the_command_space_is_kept_and_of_older_files_follows_from_the_number_of_commands() -> None:
    pair = _test(0)
    for name in ("pair_and_lens", "pan_tilt_vergence", "pair_and_lenses", "horizontal_recti"):
        space = COMMAND_SPACES[name]
        columns = {**pair.columns, **dict.fromkeys(space.names, pair.vergence_error_deg)}
        arrays = arrays_of(_kept(replace(pair, space=space, columns=columns)))
        found = from_arrays(arrays)
        assert found is not None
        assert found.space == space
        assert found.tests()[0].space == space
        unnamed = {key: values for key, values in arrays.items() if key != "command_space"}
        if "lens" not in name:
            older = from_arrays(unnamed)
            assert older is not None
            assert older.space == space
    with pytest.raises(InputError, match=r"command_space: expected one of pair, .*, got three"):
        from_arrays(arrays | {"command_space": np.array("three")})
    with pytest.raises(InputError, match=r"command_space: expected one of pair, .*, got $"):
        from_arrays(unnamed | {"activations": np.zeros((N_TRIALS, 2, 7))})


def test_the_optima_of_each_iteration_that_is_kept_are_kept() -> None:
    test = _test(0)
    optimal_w = np.random.default_rng(1).random((N_TRIALS, N + 1))
    optimal_w[3] = np.nan  # of a target out of reach
    test = replace(test, columns={**test.columns, "optimal_metabolic_rate_w": optimal_w})
    kept = _kept(test, replace(test, training_iteration=500))
    assert kept.began_otherwise.size == 0
    first, last = kept.tests()
    for k in (1, 2, 3, N):
        assert np.allclose(last.delta_cost_w(k), test.delta_cost_w(k), equal_nan=True, atol=1e-6)
    assert np.allclose(first.cost_reduction(N), test.cost_reduction(N), equal_nan=True, rtol=1e-3)


def test_the_paths_of_the_first_stimulus_are_whole(tmp_path: Path) -> None:
    test = _test(0)
    write_trials(tmp_path, _kept(test))
    (found,) = kept_tests(tmp_path)
    assert np.allclose(found.activations[:3], test.activations[:3], rtol=1e-6)
    assert np.isnan(found.activations[3:, 5]).all()
    assert np.allclose(found.activations[:, [0, N]], test.activations[:, [0, N]])


def test_tests_of_other_trials_are_forgotten() -> None:
    kept = _kept(_test(0), _test(500), _test(1000, n_trials=6))
    assert kept.training_iteration.tolist() == [1000]
    assert kept.final_error_deg.shape == (1, 6)


def test_a_full_run_is_small(tmp_path: Path) -> None:
    write_trials(tmp_path, _kept(*(_test(at, n_trials=1560) for at in range(13))))
    assert (tmp_path / KEPT_FILE).stat().st_size < 500_000


def test_nothing_kept_is_no_file(tmp_path: Path) -> None:
    write_trials(tmp_path, None)
    assert not list(tmp_path.iterdir())
    assert kept_tests(tmp_path) == []
    assert from_arrays(arrays_of(None)) is None


def test_what_is_no_trials_is_refused(tmp_path: Path) -> None:
    arrays = arrays_of(_kept(_test(0)))
    with pytest.raises(InputError, match=r"expected activations, .*, got trial$"):
        from_arrays({"trial": arrays["trial"]})
    with pytest.raises(InputError, match=r"rate_w: expected shape \(12, 5\), got \(11, 5\)"):
        from_arrays(arrays | {"rate_w": arrays["rate_w"][1:]})
    (tmp_path / KEPT_FILE).write_bytes(b"PK")
    with pytest.raises(InputError, match=r"trials\.npz: expected a state of trials_of_run"):
        kept_tests(tmp_path)
