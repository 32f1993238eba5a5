"""Make one run per seed with Ray; /shared is a folder that all machines see."""

import ray

import active_binocular_vision as abv


@ray.remote(num_cpus=1, max_retries=3)
def made(seed: int) -> abv.Run:
    """Return the run of a seed; a task that is started again continues it."""
    return abv.run("precise", seed=seed, out=f"/shared/runs/seed_{seed}", resume=True)


print(abv.compare(ray.get([made.remote(seed) for seed in range(1, 6)])))
