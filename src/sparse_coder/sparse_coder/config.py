"""Settings of the sparse coder."""

from dataclasses import dataclass, field

from lockstep import InputError, setting
from lockstep.optics import OpticsConfig, TurnNoiseConfig
from lockstep.task import TaskConfig
from sparse_coder.patches import N_PIXELS
from sparse_coder.reward import noise_energy
from sparse_coder.whitening import GAIN


@dataclass(frozen=True)
class SparseCoderConfig(TaskConfig):
    """Settings of the sparse coder; the defaults are the published model's (K17 II).

    Raises InputError for a value out of range.
    """

    learning_rate: float = setting(0.2, "eta, learning rate of the dictionaries", least=0)
    final_learning_rate_share: float = setting(
        1.0,
        "final learning rate as a share of the first; it falls linearly (D17)",
        least=0,
    )
    resting_share: float = setting(
        1.0,
        "share of training after which the learning rate keeps its final value (D17)",
        above=0,
        most=1,
    )
    plasticity_iterations: int = setting(
        0,
        "time constant of the slow mean of E, from which a fast one differs while something is left"
        " to learn: the learning rate follows that difference; 0: it falls as above",
        least=0,
    )
    suppression_iterations: int = setting(
        0,
        "time constant with which, at each place, the eye whose image the code has more of"
        " suppresses the other one; 0: both eyes always count alike",
        least=0,
    )
    random_reward: bool = setting(
        False,
        "whether the reward is a random number, uniform in [-1, 0], that says nothing of images"
        " or energy: whatever is still learned does not come from the reward",
    )
    sensor_noise: tuple[float, ...] = setting(
        (7.0,),
        "standard deviation of the noise of a pixel, by which the information is limited that"
        " lenses are rewarded for: of each scale for lenses, or one for all",
        "grey levels",
        above=0,
    )
    camera: OpticsConfig = field(default_factory=OpticsConfig)
    noise: TurnNoiseConfig = field(default_factory=TurnNoiseConfig)

    def __post_init__(self) -> None:
        """Refuse values out of range, and a task without training."""
        super().__post_init__()
        self.check_trains()
        n_for_lenses, noise = self.scales.n_for_lenses, self.sensor_noise
        if len(noise) not in (1, n_for_lenses):
            names = ", ".join(self.scales.names[self.scales.n_for_eyes :])
            raise InputError(
                f"sensor_noise: expected {n_for_lenses} entries, of {names}, or one for all, got "
                f"{list(noise)}"
            )

    @property
    def n_until_rest(self) -> float:
        """Learning steps until the dictionaries' rate has its final value."""
        return self.resting_share * self.n_training_iterations

    @property
    def noise_energies(self) -> tuple[float, ...]:
        """The energy of the sensor's noise in a patch of each scale for lenses."""
        noise, n_for_lenses = self.sensor_noise, self.scales.n_for_lenses
        of_each = noise if len(noise) > 1 else noise * n_for_lenses
        return tuple(noise_energy(sd, GAIN, N_PIXELS) for sd in of_each)
