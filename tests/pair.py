"""The pair of both eyes' medial and lateral rectus, which the paper's commands set."""

from lockstep import COMMAND_SPACES, PAIR
from lockstep.wire.topics import actor_critic_names

PAIR_SPACE = COMMAND_SPACES[PAIR]
COMMAND_NAMES = PAIR_SPACE.names
HORIZONTAL_RECTI = PAIR_SPACE.muscle_names
ACTOR_CRITIC_NAMES = actor_critic_names(PAIR_SPACE)


def pair_activations(medial: float, lateral: float) -> tuple[float, ...]:
    """Return the activations (12,) of eyes whose vertical muscles have no tone, as K17's."""
    one_eye = (medial, lateral, 0.0, 0.0, 0.0, 0.0)
    return (*one_eye, *one_eye)
