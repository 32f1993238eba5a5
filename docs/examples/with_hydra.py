"""Make a run from a Hydra configuration with profile, seed and settings."""

import hydra
from hydra.core.hydra_config import HydraConfig
from omegaconf import OmegaConf

import active_binocular_vision as abv


@hydra.main(version_base=None, config_name="config", config_path=".")  # profile, seed, settings
def main(config) -> None:
    """Make the run in the directory of the job."""
    settings = OmegaConf.to_container(config.settings)
    out = f"{HydraConfig.get().runtime.output_dir}/run"
    abv.run(config.profile, seed=config.seed, settings=settings, out=out)


main()
