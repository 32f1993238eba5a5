"""The experiment as Gymnasium environments, for other people's agents; importing registers them."""

import gymnasium

_FOLDER = __name__

gymnasium.register("ActiveVergence-v0", f"{_FOLDER}.active_vergence:PictureEnvironment")
gymnasium.register("ActiveVergenceFeatures-v0", f"{_FOLDER}.active_vergence:FeatureEnvironment")
gymnasium.register("active_binocular_vision/Vergence-v0", f"{_FOLDER}.vector:VectorEnvironment")
