"""Search a setting with Optuna."""

import optuna

import active_binocular_vision as abv

MEMORY = "vergence_rl.hindsight.memory_share"


def objective(trial: optuna.Trial) -> float:
    """Return the median error of a run with the settings of a trial."""

    def on_test(test):
        trial.report(test.median_abs_vergence_error_deg, test.iteration)
        if trial.should_prune():
            raise optuna.TrialPruned

    run = abv.run(
        "precise",
        iterations=20_000,
        tests=[5_000, 10_000],
        settings={MEMORY: trial.suggest_float("memory_share", 0.1, 2.0, log=True)},
        on_test=on_test,
        out=f"runs/{trial.number}",
    )
    return run.results["median_abs_vergence_error_deg"].iloc[-1]


optuna.create_study().optimize(objective, n_trials=20)
