"""Trains the rule that its argument names on the probe and prints the largest error."""

import sys

from lockstep import build
from tests.vergence_rl.probe import SETTINGS, gaze_errors, trained_on_gazes
from vergence_rl import Agent, VergenceRlConfig

agent = Agent(build(VergenceRlConfig, SETTINGS | {"learning_rule": sys.argv[1]}))
trained_on_gazes(agent, 1500)
print(gaze_errors(agent)[0].max())
