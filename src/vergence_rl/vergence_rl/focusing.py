"""A learning rule for eyes with lenses: verge, hold, then try one lens after the other."""

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lockstep import check_settings, setting
from vergence_rl.hindsight.config import HindsightConfig
from vergence_rl.hindsight.covered import CoveredRule
from vergence_rl.hindsight.rule import HindsightRule
from vergence_rl.learning_rule import Decision, LearningRule, Task, TimeStep

# Of the activation of a lens; 0.05 are 0.6 D at the age of 20.
_FIRST_NOISE_SD, _LEAST_NOISE_SHARE, _TARGET_SCALE = 0.05, 0.2, 0.02
# Of a lens's turn. With one place, eyes that stay far out of focus compare places that are alike.
_ANYWHERE_SHARE = 0.4
# Of the eyes' turn.
_FOCUSING_SHARE = 0.3


def focusing_iterations(n_iterations: int) -> int:
    """Return for how many iterations of the eyes' turn, its first, lenses move too."""
    return int(_FOCUSING_SHARE * n_iterations)


@dataclasses.dataclass(frozen=True)
class LensConfig:
    """Settings of how lenses are learned; raises InputError for a value out of range."""

    looking_iterations: int = setting(
        4000,
        "iterations before anything is learned of movements: eyes and lenses stay near the first"
        " places, while the dictionaries learn what is seen there",
        least=0,
    )
    ridge_share: float = setting(
        0.2, "as hindsight.ridge_share, of the weights of what is seen", above=0
    )
    felt_ridge_share: float = setting(
        0.1,
        "as hindsight.felt_ridge_share: the less, the more a lens follows what is felt",
        above=0,
    )

    def __post_init__(self) -> None:
        """Refuse values out of range."""
        check_settings(self)

    def rule_config(self, eyes: HindsightConfig) -> HindsightConfig:
        """Return the settings of a lens's rule, which remembers as long as the eyes' rule."""
        return HindsightConfig(
            exploration_variance=_FIRST_NOISE_SD**2,
            least_noise_share=_LEAST_NOISE_SHARE,
            target_scale=_TARGET_SCALE,
            ridge_share=self.ridge_share,
            felt_ridge_share=self.felt_ridge_share,
            memory_share=eyes.memory_share,
            least_memory=eyes.least_memory,
            regression_period=eyes.regression_period,
        )


@dataclasses.dataclass(frozen=True)
class _Turn:
    """A rule, its task, the commands that it gives, and the iterations in which it tries."""

    rule: LearningRule
    task: Task
    commands: slice
    first: int
    end: int

    @property
    def anywhere(self) -> range:
        """The iterations at which a lens is anywhere."""
        return range(self.first, self.first + round(_ANYWHERE_SHARE * (self.end - self.first)))


class FocusingRule:
    """Divides an episode between a rule that turns the eyes and a rule for each lens.

    First all move, so that the eyes learn what to do with a lens that has focused. Then the lenses
    stay, and the eyes try what is better. Then these stay, and one lens after the other tries:
    first anywhere within its limits, since far out of focus the reward hardly changes, then what
    its rule finds better. So a rule compares places that differ in nothing else: 0.1 deg of
    vergence changes the reward as much as 1 D does (ours). In tests all move at all times.
    """

    def __init__(
        self,
        eyes: LearningRule,
        tasks: Sequence[Task],
        lens: HindsightConfig,
        n_held: int,
        limits: tuple[NDArray[np.float64], NDArray[np.float64]],
    ) -> None:
        """Combine the rule of the eyes with a new one for each lens.

        tasks: of the eyes, whose state may lack the last features, and of each lens, whose state
        may lack the first; n_held: iterations of training, at its beginning, in which nothing is
        learned; limits: (n_muscles,) lowest and highest commands.
        """
        self._n_held, self._limits = n_held, limits
        self._n_focusing = focusing_iterations(tasks[0].iterations_per_episode)
        self._place = np.zeros(len(limits[0]))
        self._turns: list[_Turn] = []
        n_commands = n_iterations = 0
        for task in tasks:
            rule: LearningRule = HindsightRule(lens, task)
            if not self._turns:
                rule = CoveredRule(eyes, task, self._n_focusing)
            commands = slice(n_commands, n_commands + task.n_muscles)
            end = n_iterations + task.iterations_per_episode
            self._turns.append(_Turn(rule, task, commands, n_iterations, end))
            n_commands, n_iterations = commands.stop, end

    def step(
        self, observation: TimeStep, *, learning: bool, draw: np.random.Generator | None
    ) -> Decision:
        """Let the rule whose turn it is try, and learn."""
        now, place = observation.iteration, observation.activations
        looks = draw is not None and observation.training_iteration < self._n_held
        decisions, commands = [], []
        for turn in self._turns:
            is_its_turn = turn.first <= now < turn.end
            tries = looks or (is_its_turn and now < turn.end - 1)
            decision = turn.rule.step(
                self._seen_by(turn, observation),
                learning=learning and is_its_turn and not looks,
                draw=draw if tries else None,
            )
            # The first command of all is obeyed.
            moves = is_its_turn or now < max(1, self._n_focusing)
            stays = draw is not None and not moves
            decisions.append(decision)
            commands.append(place[turn.commands] if stays and not looks else decision.command)
        command = np.concatenate(commands)
        if now == 0:
            self._place = place
        if looks:
            command = self._place + command - place
        elif draw is not None and (anywhere := self._anywhere(now + 1)):
            command[anywhere] = draw.uniform(*(limit[anywhere] for limit in self._limits))
        command = np.clip(command, *self._limits)
        whose = next(
            (d for t, d in zip(self._turns, decisions, strict=True) if now < t.end), decision
        )
        return dataclasses.replace(whose, command=command, action=command - place)

    def _anywhere(self, iteration: int) -> slice | None:
        """Return the command of the lens that is anywhere at an iteration of the episode."""
        return next((t.commands for t in self._turns[1:] if iteration in t.anywhere), None)

    def _seen_by(self, turn: _Turn, observation: TimeStep) -> TimeStep:
        """Return an observation as a rule sees it, for which its turn is an episode."""
        # Regressions are solved at the ends of whole episodes.
        later = self._turns[-1].end - turn.end
        n_after = turn.task.n_felt + 1
        n_told = turn.task.n_state - n_after
        features, felt = np.split(observation.state, [-n_after])
        told = features[-n_told:] if turn.first else features[:n_told]
        return dataclasses.replace(
            observation,
            state=np.concatenate((told, felt)),
            is_compared=observation.iteration >= self._n_focusing,
            iteration=observation.iteration - turn.first,
            training_iteration=observation.training_iteration + later,
            activations=observation.activations[turn.commands],
        )

    def state(self) -> dict[str, NDArray[Any]]:
        """Return all that the rules have learned, as copies."""
        return {
            f"{owner}{name}": array
            for owner, turn in self._owners()
            for name, array in turn.rule.state().items()
        }

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Continue from what state returned, with the next episode."""
        for owner, turn in self._owners():
            turn.rule.restore({name: state[f"{owner}{name}"] for name in turn.rule.state()})

    def _owners(self) -> Iterator[tuple[str, _Turn]]:
        for i, turn in enumerate(self._turns):
            yield f"lens_{i - 1}_" if i else "", turn
