"""A run's configuration: every size of a run, read from a TOML file and checked."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    model_validator,
)

from disorder_landscape.model import disorder
from disorder_landscape.model.parameters import (
    ALPHA_RANGE,
    B_MAX,
    BIAS,
    COMPONENTS,
    MOST_SITES,
    MU_MAX,
    SITES,
    TEMPERATURE,
    FloatArray,
    Nanowire,
    check_leads,
)
from disorder_landscape.model.ranges import PARAMETER_RANGES, checked_temperature
from disorder_landscape.toml_file import checked

Positive = Annotated[int, Field(ge=1, le=10_000_000)]
"""Of wires, points, epochs and the like: so many can be counted through."""
Seed = Annotated[int, Field(ge=0, lt=2**63)]
"""As netCDF files can hold it."""
LearningRate = Annotated[float, Field(gt=0, le=1)]


class _Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class WireConfig(_Section):
    """What the paper keeps fixed of the wires, where a study wants it otherwise."""

    barrier: Annotated[float, Field(ge=-1e3, le=1e3)] = Nanowire.barrier[0]
    """V_Barrier on the first and on the last site, in meV."""
    lead_mu: Annotated[float, Field(ge=-1e3, le=1e3)] = Nanowire.lead_mu
    """Chemical potential of the leads in meV."""

    @model_validator(mode="after")
    def _conducting(self) -> WireConfig:
        check_leads(self.lead_mu, Nanowire.mass, Nanowire.lattice)
        return self

    def with_disorder(self, potential: FloatArray, alpha: float) -> Nanowire:
        """Return the wire with this V (site,) in meV and α in meV nm."""
        return Nanowire(
            potential, alpha, barrier=(self.barrier, self.barrier), lead_mu=self.lead_mu
        )


class DatasetConfig(_Section):
    """What one dataset is: disorder model, (μ, B, V_bias) grid, number of realizations."""

    realizations: Positive
    """How many wires."""
    components: Positive = COMPONENTS
    """N_dis, the disorder components c₁ … c_n that are kept."""
    alpha_range: tuple[float, float] = ALPHA_RANGE
    """α is uniform in this range in meV nm; two equal numbers fix it, and it is no label then."""
    sites: Annotated[int, Field(ge=2, le=MOST_SITES)] = SITES
    correlation_length: Annotated[float, Field(ge=1e-3, le=100)] = disorder.CORRELATION_LENGTH
    """ℓ in sites."""
    amplitude: Literal["sum", "double", "unit-variance"] = "sum"
    """Reading of "1.5 meV", see model.disorder."""
    mu_points: Positive = 15
    mu_max: Annotated[float, Field(ge=0, le=10)] = MU_MAX
    """The grid of μ goes from 0 to this, in meV."""
    B_points: Positive = 15
    B_max: Annotated[float, Field(ge=0, le=10)] = B_MAX
    """The grid of B goes from 0 to this, in T."""
    bias: tuple[float, ...] = BIAS
    """V_bias in meV."""
    temperature: Annotated[float, AfterValidator(checked_temperature)] = TEMPERATURE
    """In K."""
    energy_spacing: Annotated[float, Field(ge=1e-7, le=0.1)] | None = None
    """Of a grid of energies to average over, in meV, as the paper does; none averages exactly."""
    wire: WireConfig = WireConfig()
    seed: Seed = 0
    shard_size: Positive = 50
    """Realizations per file."""

    @model_validator(mode="after")
    def _consistent(self) -> DatasetConfig:
        low, high = self.alpha_range
        least, most, _ = PARAMETER_RANGES["alpha"]
        if not least <= low <= high <= most:
            raise ValueError(f"alpha_range must be two increasing numbers from 0 to {most:g}")
        if self.components >= self.sites:
            raise ValueError("components must be fewer than sites")
        if list(self.bias) != sorted(set(self.bias)) or not self.bias:
            raise ValueError("bias must be a non-empty increasing list")
        if not max(map(abs, self.bias)) < Nanowire.delta0:
            raise ValueError(f"bias must be within the gap of {Nanowire.delta0:g} meV")
        return self

    @property
    def mu(self) -> FloatArray:
        """Grid of chemical potentials in meV, shape (mu,)."""
        return np.linspace(0.0, self.mu_max, self.mu_points)

    @property
    def B(self) -> FloatArray:
        """Grid of magnetic fields in T, shape (B,)."""
        return np.linspace(0.0, self.B_max, self.B_points)

    @property
    def alpha_is_label(self) -> bool:
        """Whether α varies, and so is one of the labels Y."""
        return self.alpha_range[0] < self.alpha_range[1]

    @property
    def hash(self) -> str:
        """Hash of everything that decides the content of a realization (not how many there are)."""
        papers = {"wire"} if self.wire == WireConfig() else set()
        content = self.model_dump_json(exclude={"realizations"} | papers)
        return hashlib.sha256(content.encode()).hexdigest()[:16]


class NetworkConfig(_Section):
    """Which network, and its size."""

    architecture: Literal["convolutional", "residual", "recurrent"] = "convolutional"
    """The paper's network, one that it does not try, or the one that it tried first (S-II.2)."""
    width_fraction: Annotated[float, Field(gt=0, le=4)] = 1.0
    """Multiplies the filters of every convolution (Fig. S2); the paper's network is 1.0."""


class TrainingConfig(_Section):
    """How the network is trained (S-II.2)."""

    realizations: Positive | None = None
    """How many of the training realizations are used, drawn by the seed; none takes all."""
    epochs: tuple[Positive, ...] = (15, 15, 10, 5)
    """Epochs of each set; the learning rate is divided by 10 from set to set."""
    passes: Positive = 1
    """Passes over the training realizations that count as one epoch, where they are few."""
    schedule: Literal["sets", "cosine"] = "sets"
    """"cosine" lets the learning rate fall along a cosine instead, step by step, to zero."""
    learning_rate: LearningRate = 1e-4
    """Learning rate of the first set, or the largest of the cosine."""
    weight_decay: Annotated[float, Field(ge=0, le=10)] = 0.0
    """Of AdamW (Loshchilov and Hutter, ICLR 2019): each step takes away this share of the weights,
    times the learning rate. Without it, Adam."""
    batch_size: Positive = 32
    test_fraction: Annotated[float, Field(gt=0, lt=1)] = 0.1
    """The last realizations are the test set."""
    precision: Literal["float32", "mixed_bfloat16"] = "float32"
    compress_inputs: bool = False
    """Feed asinh(G/s), standardised per pixel, instead of G."""
    mirror: bool = False
    """Train on mirrored wires too, and average predictions over the mirror."""
    predict_mean: bool = False
    """Predict the mean of V too, which the paper does not; it is not counted in R²."""
    noise: Annotated[float, Field(ge=0, le=10)] = 0.0
    """Standard deviation in e²/h of Gaussian errors, drawn anew at every step."""
    noise_up_to: Annotated[float, Field(gt=0, le=10)] | None = None
    """With it, each example has a standard deviation of its own, log-uniform from `noise` to this:
    one network for measurements of all these accuracies."""
    networks: Positive = 1
    """How many are trained, with consecutive seeds; the prediction is their mean."""
    seed: Seed = 0

    @model_validator(mode="after")
    def _consistent(self) -> TrainingConfig:
        if self.noise_up_to is not None and not 0 < self.noise <= self.noise_up_to:
            raise ValueError("noise must be more than 0 and at most noise_up_to")
        if self.networks > 1 and self.realizations is not None:
            raise ValueError(
                "networks must be 1 where realizations is given: each seed draws others, and the "
                "scaling of what networks see and tell follows from them"
            )
        return self

    @property
    def largest_noise(self) -> float:
        """Largest standard deviation in e²/h of an example's errors."""
        return self.noise if self.noise_up_to is None else self.noise_up_to

    @property
    def typical_noise(self) -> float:
        """Deviation in e²/h of an example's errors, the geometric mean of those that there are."""
        return self.noise if self.noise_up_to is None else (self.noise * self.noise_up_to) ** 0.5


class FiguresConfig(_Section):
    """Which test realizations the figures show, and the resolution of their maps.

    The maps reach as far as the dataset's grid in μ and B.
    """

    realizations: tuple[Annotated[int, Field(ge=0)], ...] = (0, 1, 2, 3)
    """Which of the test realizations are drawn, (a), (b), …"""
    alpha_samples: Positive = 60
    """How many test realizations Fig. 5a shows."""
    mu_points: Positive = 81
    B_points: Positive = 101
    bias_points: Positive = 81
    visibility_refinement: Positive = 3
    """Maps of T_IV, which need one energy only, have this many times the points along μ and B."""
    pristine_mu_points: Positive = 121
    pristine_B_points: Positive = 161
    """Fig. S9 is one wire only, and the same at every preset unless these are set."""
    verification_controls: Annotated[int, Field(ge=19)] = 19
    """With how many wires of wrong disorder Fig. S10 compares."""
    verification_shifts: Positive = 7
    """How many means of V it tries for each wire."""
    tilted_B_points: Positive = 41
    """Of its maps, in a tilted field."""
    bias_max: Annotated[float, Field(gt=0, le=1)] = 0.04
    """The maps reach from minus this V_bias to this, in meV."""


class Config(_Section):
    """One run, from dataset to figures."""

    dataset: DatasetConfig
    network: NetworkConfig = NetworkConfig()
    training: TrainingConfig = TrainingConfig()
    figures: FiguresConfig = FiguresConfig()


def load_config(path: str | Path) -> Config:
    """Read and check a run's TOML file.

    Raises
    ------
    ArgumentError
        If the file cannot be read, is not TOML, or has an unknown, missing or invalid key.
    """
    return checked(Config, path, "config")
