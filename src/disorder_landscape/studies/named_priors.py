"""The priors of configs/priors, which plans call by their names."""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator

from disorder_landscape.inference.problem.prior import Prior
from disorder_landscape.runs import CONFIGS
from disorder_landscape.studies.study import one_of

PRIORS = CONFIGS / "priors"


def named_prior(name: str) -> Prior:
    """Return the prior of a file in configs/priors, which has this name without its ending."""
    return Prior.from_toml(PRIORS / f"{name}.toml")


def _there_is(name: str) -> str:
    return one_of(sorted(path.stem for path in PRIORS.glob("*.toml")), name)


PriorName = Annotated[str, AfterValidator(_there_is)]
