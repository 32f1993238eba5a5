"""From the command line of run_experiment.sh to the effective configuration of all nodes."""

import argparse
import datetime
from collections.abc import Sequence
from importlib import metadata
from pathlib import Path
from typing import Any

import yaml

from experiment_manager.config import MODELS, ExperimentManagerConfig
from experiment_manager.launch.profiles import profile_names, read_profile
from eye_plant.config import EyePlantConfig
from eye_plant.stimuli.stimulus_set import count_stimuli
from lockstep.configuration import build, flatten
from lockstep.errors import InputError
from sparse_coder.config import SparseCoderConfig
from vergence_rl.config import VergenceRlConfig

CONFIG_CLASSES: dict[str, type] = {
    "eye_plant": EyePlantConfig,
    "sparse_coder": SparseCoderConfig,
    "vergence_rl": VergenceRlConfig,
    "experiment_manager": ExperimentManagerConfig,
}
# Lambda of M_C, 1/W, by the eyes' parameter set: energy is 20 % of the reward over the first 5,000
# iterations on the generated stimuli, by which rule K17 chose its 0.035. Measured, with seed 1, by
#   run_experiment.sh --profile paper --model M_C --lambda-share 0.2
# and, for the second, with --set eye_plant.mechanics.parameter_set=anatomical.
# k17: mean E 0.3711, mean C 1.4300 W, lambda 0.0649; anatomical, of real muscle masses: mean E
# 0.4082, mean C 0.0858 W, lambda 1.190.
DEFAULT_METABOLIC_COST_WEIGHTS = {"k17": 0.065, "anatomical": 1.19}
# The pseudo-node of config.yaml that says what the run is; no ROS node has this name.
RUN_SECTION = "run"
# Who may be on another machine than the supervisor: all but the one that records.
MOVABLE_NODES = ("eye_plant", "sparse_coder", "vergence_rl")
_PACKAGES = ("mujoco", "numpy", "opencv-python-headless", "ros-jazzy-rclpy", "mcap", "numba")

Configuration = dict[str, dict[str, Any]]


def parser() -> argparse.ArgumentParser:
    """Return the command line of run_experiment.sh."""
    line = argparse.ArgumentParser(
        prog="run_experiment.sh",
        description="Train and test active binocular vision. Without arguments: a demonstration "
        "that learns vergence within ten minutes.",
    )
    line.add_argument(
        "--profile",
        metavar="NAME",
        help=f"settings to begin with: {', '.join(profile_names())} (default:"
        " paper if --model or --iterations is given, else demonstration)",
    )
    line.add_argument("--model", choices=MODELS, help="M: vergence; M_C: with a price on energy")
    line.add_argument("--iterations", type=int, metavar="N", help="training iterations")
    line.add_argument("--seed", type=int, default=1, metavar="S")
    line.add_argument(
        "--stimuli",
        type=Path,
        metavar="DIR",
        help="images instead of generated ones: train/ and test/ inside, or one directory",
    )
    line.add_argument("--out", type=Path, metavar="DIR", help="run directory (default: runs/...)")
    line.add_argument("--resume", type=Path, metavar="DIR", help="go on with an interrupted run")
    line.add_argument(
        "--elsewhere",
        default=(),
        type=_nodes,
        metavar="NODE,...",
        help="nodes that you start yourself, on another machine: of "
        f"{', '.join(MOVABLE_NODES)}; see docs/reliability.md",
    )
    line.add_argument(
        "--lambda",
        dest="weight",
        type=float,
        metavar="L",
        help="price of energy in the reward, 1/W (default for M_C: "
        f"{DEFAULT_METABOLIC_COST_WEIGHTS['k17']}; with anatomical eyes "
        f"{DEFAULT_METABOLIC_COST_WEIGHTS['anatomical']})",
    )
    line.add_argument(
        "--lambda-share",
        dest="share",
        type=float,
        metavar="S",
        help="choose lambda so that energy is this share of the reward over the first 5,000"
        " iterations; they are made once without a price, to measure it (about a minute)",
    )
    line.add_argument("--tests", metavar="N,N,...", help="training iterations before each test")
    line.add_argument("--test-stimuli", type=int, metavar="K", help="stimuli of each test")
    line.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="NODE.PARAMETER=VALUE",
        help="any parameter of any node; repeatable",
    )
    return line


def configuration_of(options: argparse.Namespace, commit: str) -> Configuration:
    """Return all parameters of all nodes, by node, checked.

    Raises InputError for whatever a node would refuse.
    """
    is_paper = options.model is not None or options.iterations is not None
    profile = read_profile(options.profile or ("paper" if is_paper else "demonstration"))
    given: Configuration = {node: dict(profile.settings.get(node, {})) for node in CONFIG_CLASSES}
    manager = given["experiment_manager"]
    model = options.model or manager.get("model", "M")
    manager |= {"model": model, "profile": profile.name, "commit": commit}
    _check_share(options)
    if options.iterations is not None:
        manager["protocol.n_training_iterations"] = options.iterations
    if options.tests is not None:
        manager["protocol.test_iterations"] = [_whole(n) for n in options.tests.split(",")]
    if options.test_stimuli is not None:
        manager["protocol.n_stimuli_per_test"] = options.test_stimuli
    if options.stimuli is not None:
        given["eye_plant"]["stimuli.directory"] = str(options.stimuli.resolve())
    for node in ("sparse_coder", "vergence_rl", "experiment_manager"):
        given[node]["seed"] = options.seed
    for setting in options.set:
        node, name, value = _setting(setting)
        given[node][name] = value
    weight = options.weight
    if weight is None:
        weight = _default_weight(given) if model == "M_C" else 0.0
    given["sparse_coder"].setdefault("metabolic_cost_weight", weight)
    return _completed(given)


def _check_share(options: argparse.Namespace) -> None:
    share = options.share
    if share is None:
        return
    if options.weight is not None:
        raise InputError("--lambda-share: expected it without --lambda, got both")
    if not 0.0 <= share < 1.0:
        raise InputError(f"--lambda-share: expected a share in [0, 1), got {share}")


def _default_weight(given: Configuration) -> float:
    mechanics = build(EyePlantConfig, given["eye_plant"]).mechanics
    return DEFAULT_METABOLIC_COST_WEIGHTS[mechanics.parameter_set]


def _completed(given: Configuration) -> Configuration:
    """Return given with what follows from it, and all defaults."""
    plant = build(EyePlantConfig, given["eye_plant"])
    manager = given["experiment_manager"]
    n_training, n_test = count_stimuli(plant.stimuli)
    manager["protocol.n_training_stimuli"] = n_training
    manager["protocol.n_test_stimuli"] = n_test
    default = ExperimentManagerConfig().protocol.n_stimuli_per_test
    wanted = manager.setdefault("protocol.n_stimuli_per_test", min(default, n_test))
    manager["protocol.n_stimuli_per_test"] = min(wanted, n_test)
    # One truth for what two nodes must know.
    manager["metabolic_cost_weight"] = given["sparse_coder"]["metabolic_cost_weight"]
    manager |= {f"mechanics.{k}": v for k, v in flatten(plant.mechanics).items()}
    given["vergence_rl"]["n_training_iterations"] = manager.get(
        "protocol.n_training_iterations", ExperimentManagerConfig().protocol.n_training_iterations
    )
    return {
        node: flatten(build(config_class, given[node]))
        for node, config_class in CONFIG_CLASSES.items()
    }


def _setting(text: str) -> tuple[str, str, Any]:
    target, equals, value = text.partition("=")
    node, dot, name = target.partition(".")
    if not equals or not dot or node not in CONFIG_CLASSES:
        raise InputError(
            f"--set: expected NODE.PARAMETER=VALUE with a node of {', '.join(CONFIG_CLASSES)}, "
            f"got {text!r}"
        )
    try:
        read = yaml.safe_load(value)
    except yaml.YAMLError as error:
        raise InputError(f"--set {text}: expected a value as YAML has it") from error
    return node, name, _number(read) if isinstance(read, str) else read


def _number(text: str) -> float | str:
    """Return the number that a text is, or the text: YAML takes 1e-5 for a word."""
    try:
        return float(text)
    except ValueError:
        return text


def _whole(text: str) -> int:
    try:
        return int(text)
    except ValueError as error:
        raise InputError(f"--tests: expected whole numbers, got {text!r}") from error


def configuration_text(configuration: Configuration) -> str:
    """Return config.yaml: a ROS parameter file of all nodes, and what the run is."""
    manager = configuration["experiment_manager"]
    run = {
        "model": manager["model"],
        "profile": manager["profile"],
        "seed": manager["seed"],
        "n_training_iterations": manager["protocol.n_training_iterations"],
        "metabolic_cost_weight": manager["metabolic_cost_weight"],
        "commit": manager["commit"],
        "date": datetime.datetime.now(tz=datetime.UTC).isoformat(timespec="seconds"),
        "versions": [f"{name} {metadata.version(name)}" for name in _PACKAGES],
    }
    sections = {f"/**/{node}": values for node, values in configuration.items()}
    document = {
        name: {"ros__parameters": values}
        for name, values in ({RUN_SECTION: run} | sections).items()
    }
    return yaml.safe_dump(document, sort_keys=False)


def read_configuration(path: Path) -> Configuration:
    """Return the parameters by node of a config.yaml; raise InputError when it is none."""
    try:
        document = yaml.safe_load(path.read_text())
        return {
            node: flatten(build(config_class, document[f"/**/{node}"]["ros__parameters"]))
            for node, config_class in CONFIG_CLASSES.items()
        }
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    except (OSError, yaml.YAMLError, KeyError, TypeError) as error:
        raise InputError(f"{path}: expected the configuration of a run: {error}") from error


def _nodes(text: str) -> tuple[str, ...]:
    nodes = tuple(dict.fromkeys(text.split(",")))
    if unknown := [node for node in nodes if node not in MOVABLE_NODES]:
        raise argparse.ArgumentTypeError(
            f"expected some of {', '.join(MOVABLE_NODES)}, got {unknown[0]!r}"
        )
    return nodes


def arguments(argv: Sequence[str] | None) -> argparse.Namespace:
    """Return the parsed command line; exits with 2 and a usage line when it cannot be parsed."""
    return parser().parse_args(argv)
