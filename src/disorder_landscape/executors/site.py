"""A site's settings for jobs of Slurm, in a TOML file."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, field_validator

from disorder_landscape.toml_file import checked

Count = Annotated[int, Field(ge=1, le=1_000_000)]


class Site(BaseModel):
    """What a job asks of Slurm, and what it does before it begins."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    partition: str
    """Name of the partition, as `sinfo` prints it."""
    jobs: Count
    """How many jobs share the tasks out, at most."""
    minutes: Count = 60
    """Time limit of a job. What it has not done by then is done by the next one."""
    memory_gb: Annotated[float, Field(gt=0, le=10_000)] = 4.0
    """Memory of a job in GB."""
    cores: Annotated[int, Field(ge=1, le=1024)] = 1
    """Cores of a job, each with a process of its own."""
    at_a_time: Count | None = None
    """How many jobs may run at a time; none leaves it to Slurm."""
    options: dict[str, str] = {}
    """Further options of sbatch, without dashes: account = "physics"."""
    setup: tuple[str, ...] = ()
    """Lines of shell before the command: module load python."""

    @field_validator("partition")
    @classmethod
    def _one_word(cls, value: str) -> str:
        if not re.fullmatch(r"[\w.,+-]+", value):
            raise ValueError("it must be the name of a partition")
        return value

    @field_validator("options")
    @classmethod
    def _options(cls, value: dict[str, str]) -> dict[str, str]:
        for name, text in value.items():
            if not re.fullmatch(r"[a-z][a-z-]*", name) or "\n" in text:
                raise ValueError(f"'{name}' must be an option of sbatch, with one line of text")
        return value


def load_site(path: Path) -> Site:
    """Read a site's TOML file.

    Raises
    ------
    ArgumentError
        If it cannot be read, or has an unknown, missing or invalid key.
    """
    return checked(Site, path, "site")
