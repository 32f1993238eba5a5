"""The experiment as Gymnasium environments, for other people's agents; importing registers them."""

import gymnasium

_MODULE = "active_binocular_vision.environments.active_vergence"

gymnasium.register("ActiveVergence-v0", f"{_MODULE}:PictureEnvironment")
gymnasium.register("ActiveVergenceFeatures-v0", f"{_MODULE}:FeatureEnvironment")
