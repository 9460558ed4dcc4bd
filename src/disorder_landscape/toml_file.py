"""TOML files, read and checked against a model, with one sentence for what is wrong."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import TypeVar

from pydantic import BaseModel, RootModel, ValidationError

from disorder_landscape.arguments import ArgumentError

Model = TypeVar("Model", bound=BaseModel)


def checked(
    model: type[Model], path: str | Path, name: str, content: Mapping[str, object] | None = None
) -> Model:
    """Read a TOML file, or take its content as given, and check it against a model.

    Raises
    ------
    ArgumentError
        Of the given argument name, if the file cannot be read, is not TOML, or has an unknown,
        missing or invalid key.
    """
    try:
        return model.model_validate(read_toml(path, name) if content is None else content)
    except ValidationError as error:
        first = min(error.errors(), key=lambda one: one["type"] != "extra_forbidden")  # a typo
        # The tag of a union is no key.
        place = first["loc"][1:] if issubclass(model, RootModel) else first["loc"]
        key = ".".join(str(part) for part in place) or "the file"
        messages = {
            "extra_forbidden": "it has the unknown key {key}",
            "missing": "it lacks the key {key}",
        }
        message = messages.get(first["type"], "{key} is wrong: {message}")
        but = message.format(
            key=key, message=first["msg"].removeprefix("Value error, ").rstrip(".")
        )
        raise ArgumentError(name, f"be right ('{path}')", but) from None


def read_toml(path: str | Path, name: str) -> dict[str, object]:
    """Return what a TOML file holds.

    Parameters
    ----------
    path : str or Path
    name : str
        Of the argument, for the error.

    Raises
    ------
    ArgumentError
        If it cannot be read, or is none.
    """
    try:
        with open(path, "rb") as file:
            return tomllib.load(file)
    except OSError as error:
        but = f"'{path}' cannot be read ({error.strerror})"
        raise ArgumentError(name, "be a readable TOML file", but) from None
    except (ValueError, RecursionError) as error:  # also of too many digits, or of nesting
        raise ArgumentError(name, "be a TOML file", f"'{path}' is not: {error}") from None
