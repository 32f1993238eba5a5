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
    rewards_information: bool = setting(
        False,
        "whether the reward is the information that the code has of the windows, which is largest"
        " in focus, instead of -E, which rises with blur",
    )
    sensor_noise: tuple[float, ...] = setting(
        (7.0,),
        "standard deviation of the noise of a pixel that is coded, by which that information is"
        " limited: of each scale, or one for all",
        "grey levels",
        above=0,
    )
    first_sensor_noise: tuple[float, ...] = setting(
        (0.0,),
        "the same until resting_share of training; 0: as sensor_noise",
        "grey levels",
        least=0,
    )
    camera: OpticsConfig = field(default_factory=OpticsConfig)
    noise: TurnNoiseConfig = field(default_factory=TurnNoiseConfig)

    def __post_init__(self) -> None:
        """Refuse values out of range, and a task without training."""
        super().__post_init__()
        self.check_trains()
        n_scales = len(self.scales.all)
        for name in ("sensor_noise", "first_sensor_noise"):
            noise = getattr(self, name)
            if len(noise) not in (1, n_scales):
                raise InputError(
                    f"{name}: expected {n_scales} entries, of {', '.join(self.scales.names)}, or "
                    f"one for all, got {list(noise)}"
                )

    @property
    def n_until_rest(self) -> float:
        """Learning steps until the dictionaries' rate has its final value."""
        return self.resting_share * self.n_training_iterations

    def noise_energies(self, learning_steps: int) -> tuple[float, ...]:
        """Return the energy of the sensor's noise in a patch of each scale, after these steps."""
        first, later = map(self._of_each_scale, (self.first_sensor_noise, self.sensor_noise))
        if learning_steps < self.n_until_rest:
            later = tuple(a or b for a, b in zip(first, later, strict=True))
        gain = GAIN if self.scales.whitened else 1.0
        return tuple(noise_energy(sd, gain, N_PIXELS) for sd in later)

    def _of_each_scale(self, noise: tuple[float, ...]) -> tuple[float, ...]:
        return noise if len(noise) > 1 else noise * len(self.scales.all)
