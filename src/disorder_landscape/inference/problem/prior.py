"""What is known of a device before the measurement, and what is not."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from difflib import get_close_matches
from pathlib import Path
from typing import Any, Self

from disorder_landscape.arguments import (
    number_in,
    require,
    shown,
    whole_number_in,
)
from disorder_landscape.config import DatasetConfig
from disorder_landscape.inference.problem.agreement import check_agreement, check_biases
from disorder_landscape.inference.problem.distributions import (
    Belief,
    Distribution,
    Normal,
    Uniform,
    belief_of,
)
from disorder_landscape.inference.problem.measurement import Measurement
from disorder_landscape.inference.problem.parameters import BY_NAME, PARAMETERS
from disorder_landscape.model.disorder import (
    CORRELATION_LENGTH,
    MEAN_STD,
    NOISE_STD,
    noise_std_of,
)
from disorder_landscape.model.parameters import (
    MOST_SITES,
    SITES,
    Nanowire,
    check_leads,
)
from disorder_landscape.model.ranges import PARAMETER_RANGES
from disorder_landscape.toml_file import read_toml

Given = float | tuple[float, float] | Distribution | None
ALL = "all"
"""What a file says for the components of the whole landscape."""
ALWAYS_KNOWN = ("mass", "lattice", "lead_mu")
"""Parameters that are always known: conductances hardly tell them from others (PHYSICS: the lever
arm from the mass, the barriers from the leads' chemical potential)."""


@dataclass(frozen=True)
class Prior:
    """What is known of a device before it is measured.

    Parameters of the device are a number (known), a pair (low, high; uniform between these) or a
    normal distribution (`Normal(mean, std)`). None stands for what the measurement states, or else
    for the paper's value.

    Parameters
    ----------
    components : int or None
        How many cosine components the disorder has, besides its mean; None for the whole landscape:
        V of every site, a Gaussian process.
    sites : int
    correlation_length : float
        ℓ of the disorder in sites, 1e-3 to 100.
    amplitude : float
        Standard deviation in meV of the white noise per site whose running mean over ℓ the disorder
        is; the paper's 1.5.
    mean_std : float
        Standard deviation in meV of the mean of V.
    alpha : meV nm
    g : no unit
    gamma, delta0 : meV
    critical_field : T
    dissipation : meV
    temperature : K
    barrier_left, barrier_right : meV
    bias_offset, mu_offset : meV
        Added to the biases and to the chemical potentials that the measurement states.
    lever_arm : meV
        By which the measured axis is multiplied: meV per unit of `gate`, or 1 of `mu`.
    mass, lattice, lead_mu : float
        As in `Nanowire`, known.

    Raises
    ------
    ArgumentError
        If one of them is something else, or out of range.
    """

    components: int | None = 10
    sites: int = SITES
    correlation_length: float = CORRELATION_LENGTH
    amplitude: float = NOISE_STD
    mean_std: float = MEAN_STD
    alpha: Given = None
    g: Given = None
    gamma: Given = None
    delta0: Given = None
    critical_field: Given = None
    dissipation: Given = None
    temperature: Given = None
    barrier_left: Given = None
    barrier_right: Given = None
    bias_offset: Given = None
    lever_arm: Given = None
    mu_offset: Given = None
    mass: float = Nanowire.mass
    lattice: float = Nanowire.lattice
    lead_mu: float = Nanowire.lead_mu

    def __post_init__(self) -> None:
        checked: dict[str, Any] = {"sites": whole_number_in("sites", self.sites, 2, MOST_SITES)}
        must = f'be a whole number, or None for V of every site ("{ALL}" in a file)'
        is_word = isinstance(self.components, str)
        require(not is_word, "components", must, f"it is {shown(self.components)}")
        if self.components is not None:
            checked["components"] = whole_number_in(
                "components", self.components, 1, checked["sites"] - 1
            )
        for name, low, high, unit in (
            ("correlation_length", 1e-3, 100.0, "sites"),
            ("amplitude", 1e-6, 1e3, "meV"),
            ("mean_std", 1e-9, 1e3, "meV"),
        ):
            checked[name] = number_in(name, getattr(self, name), low, high, unit)
        for name in ALWAYS_KNOWN:
            checked[name] = number_in(name, getattr(self, name), *PARAMETER_RANGES[name])
        for one in PARAMETERS:
            if (given := getattr(self, one.name)) is not None:
                checked[one.name] = belief_of(one.name, given, one.low, one.high, one.unit)
        for name, value in checked.items():
            object.__setattr__(self, name, value)

    def to_dict(self) -> dict[str, Any]:
        """Return what `from_mapping` takes, without what is left to the measurement."""
        content: dict[str, Any] = {}
        for of in fields(self):
            value = getattr(self, of.name)
            if isinstance(value, Uniform):
                value = list(value.range)
            elif isinstance(value, Normal):
                value = {"mean": value.mean, "std": value.std}
            if value is not None:
                content[of.name] = value
        return {"components": ALL} | content

    @property
    def unknown(self) -> dict[str, Distribution]:
        """The parameters that are unknown, in the order in which they enter."""
        given = {one.name: getattr(self, one.name) for one in PARAMETERS}
        return {name: x for name, x in given.items() if isinstance(x, Uniform | Normal)}

    @property
    def known(self) -> dict[str, float]:
        """The parameters that are known, in the order in which they enter."""
        given = {one.name: getattr(self, one.name) for one in PARAMETERS}
        return {name: x for name, x in given.items() if isinstance(x, float)}

    @property
    def fixed(self) -> dict[str, float]:
        """The parameters that are always known."""
        return {name: getattr(self, name) for name in ALWAYS_KNOWN}

    def for_measurement(self, measurement: Measurement) -> Self:
        """Return the prior with all parameters said, the rest by the measurement or the paper.

        Raises
        ------
        ArgumentError
            If both say different things, biases may lie beyond the gap, or nothing could conduct.
        """
        check_leads(self.lead_mu, self.mass, self.lattice)
        for name in ALWAYS_KNOWN:
            check_agreement(name, getattr(self, name), measurement.stated.get(name))
        if measurement.axis == "gate":
            must = "say a lever arm, in meV per unit of the measurement's gate"
            require(self.lever_arm is not None, "prior", must, "it says none")
        usual = {one.name: one.usual for one in PARAMETERS} | measurement.settings
        said: dict[str, Any] = {}
        for name, value in usual.items():
            belief: Belief | None = getattr(self, name)
            stated = measurement.stated.get(name)
            if belief is None:
                said[name] = belief_of(name, value if stated is None else stated, *_range(name))
            else:
                check_agreement(name, belief, stated)
        whole = replace(self, **said)
        gap, critical_field = (whole.extremes(name)[0] for name in ("delta0", "critical_field"))
        check_biases(measurement, gap, critical_field, max(map(abs, whole.extremes("bias_offset"))))
        return whole

    def extremes(self, name: str) -> tuple[float, float]:
        """Return the least and the largest value of a parameter that is said."""
        belief = getattr(self, name)
        return (belief, belief) if isinstance(belief, float) else belief.range

    @classmethod
    def of_dataset(cls, config: DatasetConfig) -> Self:
        """Return the prior from which the wires of a dataset are drawn.

        Temperature and barriers are left to the measurement.
        """
        low, high = config.alpha_range
        given: dict[str, Any] = {
            one.name: one.usual for one in PARAMETERS if one.name in PARAMETER_RANGES
        }
        given["alpha"] = (low, high) if low < high else low
        return cls(
            components=config.components,
            sites=config.sites,
            correlation_length=config.correlation_length,
            amplitude=noise_std_of(config.amplitude, config.correlation_length),
            lead_mu=config.wire.lead_mu,
            **given,
        )

    @classmethod
    def from_mapping(cls, given: Mapping[str, Any]) -> Self:
        """Return the prior that a mapping describes, as a TOML file holds it.

        Raises
        ------
        ArgumentError
            As for a prior, or if it says something else besides.
        """
        known = [of.name for of in fields(cls)]
        for name in given:
            must = f"say something of {', '.join(known)}"
            close = get_close_matches(str(name).lower(), known, 1)
            meant = f" (is {close[0]} meant?)" if close else ""
            require(name in known, "prior", must, f"it says something of {shown(name)}{meant}")
        content = dict(given)
        if content.get("components") == ALL:
            content["components"] = None
        return cls(**content)

    @classmethod
    def from_toml(cls, path: str | Path) -> Self:
        """Return the prior that a TOML file describes.

        Raises
        ------
        ArgumentError
            As for a prior, or if the file cannot be read.
        """
        return cls.from_mapping(read_toml(path, "prior"))


def _range(name: str) -> tuple[float, float, str]:
    one = BY_NAME[name]
    return one.low, one.high, one.unit
