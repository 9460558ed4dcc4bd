"""Keras, imported late and set up once: quiet, and with the same numbers in every run."""

from __future__ import annotations

import os
from functools import cache
from importlib import import_module
from typing import Any


@cache
def import_keras() -> Any:
    """Return the module `keras`, with the TensorFlow backend set to deterministic operations.

    Importing TensorFlow takes ten seconds and more, so only functions that need a network call
    this. The environment variable KERAS_BACKEND chooses another backend.
    """
    os.environ.setdefault("TF_CPP_MIN_LOG_LEVEL", "2")  # no start-up notes on the terminal
    keras = import_module("keras")
    if keras.backend.backend() == "tensorflow":
        import_module("tensorflow").config.experimental.enable_op_determinism()
    return keras
