"""Keras, imported late and set up once: quiet, and with the same numbers in every run."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from importlib import import_module
from tempfile import TemporaryFile
from typing import Any

from disorder_landscape.parts import needs


@cache
def import_keras() -> Any:
    """Return the module `keras`, with the TensorFlow backend set to deterministic operations.

    Importing TensorFlow takes ten seconds and more, so only functions that need a network call
    this. The environment variable KERAS_BACKEND chooses another backend.
    """
    os.environ.setdefault("TF_CPP_MIN_LOG_LEVEL", "2")  # no notes on devices when it first computes
    with needs("learning"), _stderr_unless_it_fails():
        keras = import_module("keras")
        if keras.backend.backend() == "tensorflow":
            import_module("tensorflow").config.experimental.enable_op_determinism()
    return keras


@contextmanager
def _stderr_unless_it_fails() -> Iterator[None]:
    """Show what is written to the process's standard error only where an exception follows.

    TensorFlow's libraries write start-up notes there before they know of any log level.
    """
    sys.stderr.flush()
    kept = os.dup(2)
    with TemporaryFile() as notes:
        os.dup2(notes.fileno(), 2)
        try:
            yield
        except BaseException:
            notes.seek(0)
            os.write(kept, notes.read())
            raise
        finally:
            sys.stderr.flush()
            os.dup2(kept, 2)
            os.close(kept)
