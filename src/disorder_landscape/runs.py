"""Runs, and where everything is that they make.

A run is a configuration and a folder of results: build/<name>/model, build/<name>/evaluation.nc.
Its dataset is in build/datasets, which all runs and studies share. A preset has a run for each of
the paper's two models, of five components and α, configs/<preset>.toml, and of ten components,
configs/<preset>_ten_components.toml; where there is no such file, the shipped network stands for
it. What is shipped needs no dataset: models and test sets are in data_small.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from disorder_landscape.arguments import require
from disorder_landscape.config import Config, DatasetConfig, load_config
from disorder_landscape.learning.model_files import is_trained

REPOSITORY = Path(__file__).resolve().parents[2]
CONFIGS = REPOSITORY / "configs"
SHIPPED = "shipped"
FIVE, TEN = MODELS = "five_components_and_alpha", "ten_components"
"""The paper's two models, as they are named where they are shipped."""
THIRTY = "thirty_components"
"""A network to start inversions from, which is shipped too. No figure is drawn of it."""
NOISY = "noisy"
"""The preset of networks for measurements with errors, which are shipped too: FIVE_noisy, …"""
NOISY_FROM = 0.002
"""In e²/h: for errors of this and more they are the ones to use; the others know 0.001."""


def dataset_folder(config: DatasetConfig, build: Path) -> Path:
    """Return the folder of a dataset's shards, whoever asks for it."""
    return build / "datasets" / config.hash


@dataclass(frozen=True)
class Run:
    """A configuration and the folder of its results.

    Parameters
    ----------
    name : str
        The configuration file's, or the shipped model's.
    config : Config
    folder : Path
        Of everything that is made.
    shipped : bool
        Whether model and test set are those in data_small.
    """

    name: str
    config: Config
    folder: Path
    shipped: bool = False

    @property
    def dataset_folder(self) -> Path:
        """Folder of the shards."""
        return dataset_folder(self.config.dataset, self.folder.parent)

    @property
    def model_folder(self) -> Path:
        """Folder of the trained network."""
        return shipped_model(self.name) if self.shipped else self.folder / "model"

    @property
    def is_trained(self) -> bool:
        """Whether the folder of the network holds a finished training."""
        return is_trained(self.model_folder)

    @property
    def evaluation_file(self) -> Path:
        """Test realizations and predictions."""
        return self.folder / "evaluation.nc"


def open_run(config: str | Path, build: str | Path = "build") -> Run:
    """Return the run of a configuration file; its name is the file's."""
    return Run(Path(config).stem, load_config(config), Path(build) / Path(config).stem)


def shipped_model(model: str, noise: float = 0.0) -> Path:
    """Return the folder of a shipped network, the one for measurements with such errors in e²/h."""
    name = model if noise < NOISY_FROM else f"{model}_{NOISY}"
    return REPOSITORY / "data_small" / "models" / name


def shipped_test_set(model: str) -> Path:
    """Return the file of the test realizations that are shipped with a network."""
    return REPOSITORY / "data_small" / f"{model}_test.nc"


def presets() -> list[str]:
    """Return the names of the presets: those of configs/ that are of both models, and "shipped"."""
    there = {path.stem for path in CONFIGS.glob("*.toml")} - {THIRTY}
    return sorted({name.removesuffix(f"_{TEN}") for name in there} | {SHIPPED})


def preset_run(preset: str, build: str | Path = "build", model: str = FIVE) -> Run:
    """Return a preset's run of one of the paper's two models.

    Parameters
    ----------
    preset : str
        A name in configs/, or "shipped".
    build : path
        Where the folder of the run is, or will be.
    model : {"five_components_and_alpha", "ten_components"}
        Presets that have a configuration of one of them only take the shipped network for the
        other, and draw both alike.

    Raises
    ------
    ArgumentError
        If there is no such preset.
    """
    known = presets()
    require(preset in known, "preset", f"be one of {', '.join(known)}", f"it is '{preset}'")
    there = {path.stem for path in CONFIGS.glob("*.toml")}
    name = preset if model == FIVE else f"{preset}_{model}"
    if name in there:
        return open_run(CONFIGS / f"{name}.toml", build)
    from disorder_landscape.learning.model import load_model_config

    config = load_model_config(shipped_model(model))
    other = {preset, f"{preset}_{TEN}"} & there
    if other:
        figures = load_config(CONFIGS / f"{other.pop()}.toml").figures
        config = config.model_copy(update={"figures": figures})
    return Run(model, config, Path(build) / SHIPPED / model, shipped=True)
