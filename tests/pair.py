"""The pair of both eyes' medial and lateral rectus, which the paper's commands set."""

from lockstep.command_space import COMMAND_SPACES, PAIR
from lockstep.wire.topics import actor_critic_names

COMMAND_NAMES = COMMAND_SPACES[PAIR].names
HORIZONTAL_RECTI = COMMAND_SPACES[PAIR].muscle_names
ACTOR_CRITIC_NAMES = actor_critic_names(COMMAND_SPACES[PAIR])


def pair_activations(medial: float, lateral: float) -> tuple[float, ...]:
    """Return the activations (12,) of eyes whose vertical muscles have no tone, as K17's."""
    one_eye = (medial, lateral, 0.0, 0.0, 0.0, 0.0)
    return (*one_eye, *one_eye)
