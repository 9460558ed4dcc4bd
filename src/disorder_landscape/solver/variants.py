"""The variants of the compiled core, one for each set of instructions.

They are the modules that CMakeLists.txt builds from core/binding.cpp. The environment variable
DISORDER_LANDSCAPE_CORE names one; else it is the best that this CPU can run.
"""

from __future__ import annotations

import os
from importlib import import_module
from types import ModuleType

from disorder_landscape.arguments import require

CHOICE = "DISORDER_LANDSCAPE_CORE"
VARIANTS = ("baseline", "avx2", "avx512")


def variant(name: str) -> ModuleType:
    """Return the module of one variant; the CPU must be able to run it.

    Raises
    ------
    ImportError
        If it was not built.
    """
    module = f"{__package__}._core_{name}"
    try:
        return import_module(module)
    except ModuleNotFoundError as error:
        if error.name != module:
            raise
        raise ImportError(
            f"The compiled core ({module}) was not built for this Python and platform: "
            "run `make setup` where the sources are, or install the package here from them.",
            name=module,
        ) from None


def supported() -> list[str]:
    """Return the variants that this CPU can run, from the slowest to the fastest."""
    names: list[str] = variant("baseline").supported_variants()
    return names


def chosen() -> str:
    """Return which variant to use: the fastest, or what the environment says.

    Raises
    ------
    ArgumentError
        If the environment names none, or one that this CPU cannot run.
    """
    names = supported()
    choice = os.environ.get(CHOICE)
    if not choice:
        return names[-1]
    require(choice in VARIANTS, CHOICE, f"be one of {', '.join(VARIANTS)}", f"it is {choice!r}")
    require(
        choice in names, CHOICE, f"be what this CPU can run ({', '.join(names)})", f"it is {choice}"
    )
    return choice
