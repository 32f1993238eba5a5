"""Copies of environments, pickled ones, and those in other processes, do as the original does."""

import copy
import os
import pickle
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

import active_binocular_vision.environments  # noqa: F401 (registers them)
from active_binocular_vision.environments.one_thread import OneThread
from eye_plant.camera.config import MUJOCO, RENDERERS
from lockstep import InputError
from tests.eye_plant.opengl import need_opengl
from tests.patience import PATIENCE_S

ID = "ActiveVergenceFeatures-v0"


@pytest.fixture
def settings(pictures: Path) -> dict[str, Any]:
    """Return settings small enough for tests, with what NumPy and pathlib give."""
    return {
        "eye_plant.stimuli.directory": pictures,
        "eye_plant.stimuli.size_px": np.int64(64),
        "task.n_bases": np.int32(32),
        "eyes.mechanics.strength": np.full(12, 0.9, np.float32),
    }


@pytest.fixture(params=RENDERERS)
def drawing(request: pytest.FixtureRequest, settings: dict[str, Any]) -> dict[str, Any]:
    """Return settings with one renderer after the other."""
    if request.param == MUJOCO:
        need_opengl()
    return settings | {"eyes.camera.renderer": request.param}


def _course(environment: gymnasium.Env, actions: np.ndarray) -> bytes:
    """Return all that an environment gives out, to the end of an episode and into the next."""
    given: list[Any] = []
    for action in actions:
        given.append(environment.step(action))
        if given[-1][3]:
            given.append(environment.reset())
    return pickle.dumps(given)


@pytest.mark.parametrize("profile", ["paper", "gaze"])
@pytest.mark.parametrize(
    "copied", [copy.deepcopy, copy.copy, lambda made: pickle.loads(pickle.dumps(made))]
)
def test_a_copy_steps_to_the_same_bits(
    drawing: dict[str, Any], profile: str, copied: Callable[[gymnasium.Env], gymnasium.Env]
) -> None:
    made = gymnasium.make(ID, profile=profile, settings=drawing)
    draw = np.random.default_rng(2)
    actions = draw.uniform(-0.1, 0.1, (13, *(made.action_space.shape or ())))
    made.reset(seed=1)
    made.step(actions[0])
    if copied is copy.copy:
        made = made.unwrapped  # the wrappers are Gymnasium's
    other, third = copied(made), copied(made)
    expected = _course(other, actions)
    assert _course(made, actions) == expected, "the copy has moved the original"
    assert _course(third, actions) == expected
    other.close()
    made.step(actions[0])


PROCESSES = """
import gymnasium, numpy as np, sys
import active_binocular_vision.environments

if __name__ == "__main__":
    settings = {"eye_plant.stimuli.directory": sys.argv[1], "eye_plant.stimuli.size_px": 64}
    arguments = {"settings": settings | {"eyes.camera.renderer": sys.argv[2]}}
    own = gymnasium.make("ActiveVergenceFeatures-v0", **arguments)
    own.reset(seed=1)
    expected = own.step(np.zeros(2))[0]["features"]
    for context in sys.argv[3:]:
        made = gymnasium.make_vec(
            "ActiveVergenceFeatures-v0",
            num_envs=1,
            vectorization_mode="async",
            vector_kwargs={"context": context},
            **arguments,
        )
        try:
            made.reset(seed=1)
        except ValueError as error:
            print(type(error).__name__, error)
            continue
        assert (made.step(np.zeros((1, 2)))[0]["features"][0] == expected).all()
        made.close()
        print(context)
"""


def _in_processes(folder: Path, pictures: Path, *arguments: str) -> str:
    program = folder / "program.py"
    program.write_text(PROCESSES)
    done = subprocess.run(
        [sys.executable, program, pictures, *arguments],
        env=os.environ | {"MUJOCO_GL": "egl" if MUJOCO in arguments else "disable"},
        capture_output=True,
        text=True,
        check=False,
        timeout=600,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_other_processes_do_the_same_however_they_start(tmp_path: Path, pictures: Path) -> None:
    contexts = ["fork", "spawn", "forkserver"]
    assert _in_processes(tmp_path, pictures, "plane", *contexts).split() == contexts


def test_a_fork_of_a_process_with_opengl_is_refused(tmp_path: Path, pictures: Path) -> None:
    need_opengl()
    said = _in_processes(tmp_path, pictures, MUJOCO, "fork", "spawn").splitlines()
    assert said[0].startswith("InputError camera.renderer mujoco: expected a process of its own")
    assert said[1:] == ["spawn"]


def _threads() -> set[int]:
    return {pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"}


def test_an_environment_computes_on_one_thread_and_leaves_the_users_own(settings) -> None:
    made = gymnasium.make(ID, settings=settings).unwrapped
    within = []
    observe = made._observe  # type: ignore[attr-defined]
    made._observe = lambda seen: within.append(_threads()) or observe(seen)  # type: ignore[attr-defined, func-returns-value]
    with threadpool_limits(2, user_api="blas"):
        made.reset(seed=1)
        made.step(np.zeros(2))
        assert _threads() == {2}
        with pytest.raises(InputError):
            made.step(np.zeros(1))
        assert _threads() == {2}
        assert within == [{1}, {1}]
        limit = OneThread()
        with limit:
            with limit:  # as another thread would
                pass
            assert _threads() == {1}
        assert _threads() == {2}


def test_each_thread_computes_on_one_whoever_has_set_limits_before() -> None:
    limit, found = OneThread(), []

    def compute() -> None:
        with limit:
            found.append(_threads())

    with threadpool_limits(2, user_api="blas"):
        for _ in range(2):
            compute()
            other = threading.Thread(target=compute)
            other.start()
            other.join(PATIENCE_S)
            assert _threads() == {2}
    assert found == [{1}] * 4


def test_generating_stimuli_is_announced(settings, tmp_path: Path, capsys) -> None:
    generated = {
        "eye_plant.stimuli.directory": "",
        "eye_plant.stimuli.cache_directory": tmp_path,
        "eye_plant.stimuli.n_training": 1,
        "eye_plant.stimuli.n_test": 1,
    }
    gymnasium.make(ID, settings=settings | generated).close()
    assert "generating 2 stimuli, once" in capsys.readouterr().err
    made = gymnasium.make(ID, settings=settings | generated)
    assert "generating" not in capsys.readouterr().err
    assert len(pickle.dumps(made)) < 10**6, "generated pictures are loaded again"
