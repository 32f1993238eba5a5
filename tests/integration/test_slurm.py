"""A sweep as a job array of a real Slurm: its results are those of the local pool."""

import re
from collections.abc import Iterator

import pytest

from experiment_manager.sweep.sweep_file import read_sweep
from tests.slurm_cluster import PARTITION, Cluster, cluster, why_not
from tests.supervised_run import differences
from tests.supervisor import finished
from tests.sweep_harness import (
    are_held_at_first_checkpoint,
    goes_on_interrupted,
    start_sweep,
    whole_sweep,
)


@pytest.fixture
def slurm() -> Iterator[Cluster]:
    if reason := why_not():
        pytest.skip(reason)
    with cluster(n_cores=2) as started:
        yield started


def test_tasks_that_are_requeued_end_with_the_results_of_the_pool(
    slurm, pictures, tmp_path, tmp_path_factory
) -> None:
    pool = whole_sweep(tmp_path_factory, pictures)
    sweep_file = pool.with_name("small.yaml")
    directory = tmp_path / "50%jobs"  # Slurm's patterns begin with %
    words = ["--slurm", "--partition", PARTITION, "--time", "60", "--tasks", "2"]
    output = finished(start_sweep(sweep_file, "--out", directory, *words, **slurm.variables))
    found = re.search(r"^job (\d+): 3 tasks; ", output, re.MULTILINE)
    assert found, output
    job = found[1]
    killed, warned, _ = runs = [directory / name for name in read_sweep(sweep_file).runs()]
    slurm.wait_until(
        lambda: are_held_at_first_checkpoint([killed, warned]),
        "the checkpoints of the first two tasks",
    )
    # Kills the process, then puts the task back into the queue, as for a node that is needed.
    slurm.call("scontrol", "requeue", f"{job}_0")
    # As Slurm does two minutes before the end of a task's time.
    slurm.call("scancel", "--batch", "--signal=USR1", f"{job}_1")
    slurm.wait_until(lambda: goes_on_interrupted(warned), "the interrupt of the second task")
    slurm.wait_until(slurm.is_idle, "the end of the job")
    status = finished(start_sweep(directory, "--status"))
    assert "3 done" in status, slurm.logs()
    log = (directory / "logs" / f"{warned.name}.log").read_text()
    assert "stopping after this episode, with a checkpoint" in log
    assert (directory / "logs" / "slurm_0.out").exists()
    for run in runs:
        assert differences(run, pool / run.name) == []
    assert "3 done" in finished(start_sweep(directory, "--slurm", **slurm.variables))

    # What Slurm refuses is one line, before anything is written.
    words = ["--slurm", "--partition", "nowhere"]
    sweep = start_sweep(sweep_file, "--out", tmp_path / "no", *words, **slurm.variables)
    output = finished(sweep, code=2)
    assert output.count("error: ") == 1
    assert "error: --slurm: invalid partition specified: nowhere" in output
    assert not (tmp_path / "no").exists()
