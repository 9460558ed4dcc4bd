"""What all tests of the physics share."""

import pytest

from disorder_landscape.physics.compilation import compile_kernels


@pytest.fixture(scope="session", autouse=True)
def _kernels():
    """Load the kernels before any test calls a function that they hold copies of by itself."""
    compile_kernels()
