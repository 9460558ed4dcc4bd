"""The types of core/binding.cpp, of which every variant is compiled."""

from types import ModuleType

import numpy as np
from numpy.typing import NDArray

from disorder_landscape.model.hamiltonian import ComplexArray
from disorder_landscape.model.parameters import FloatArray

TOLERANCE: float
FLOOR: float
REACH: float
BELOW_GAP: float
NODES: list[int]
COMPARED: int
internals: ModuleType
GROWTH_LIMIT: float

def instruction_set() -> str: ...
def supported_variants() -> list[str]: ...
def set_threads(count: int) -> int: ...
def conductance(
    V: FloatArray,
    parameters: FloatArray,
    mu: FloatArray,
    B: FloatArray,
    omega: FloatArray,
    theta: float,
    growth_limit: float,
) -> FloatArray: ...
def reflection_determinant(
    V: FloatArray,
    parameters: FloatArray,
    mu: FloatArray,
    B: FloatArray,
    theta: float,
    growth_limit: float,
) -> FloatArray: ...
def thermal_conductance(
    V: FloatArray,
    parameters: FloatArray,
    mu: FloatArray,
    B: FloatArray,
    bias: FloatArray,
    kT: float,
    tolerance: float,
    growth_limit: float,
) -> tuple[FloatArray, FloatArray, FloatArray]: ...
def conductance_gradient(
    V: FloatArray,
    parameters: FloatArray,
    mu: FloatArray,
    B: FloatArray,
    omega: FloatArray,
    biases: NDArray[np.int64],
    bias_count: int,
    slopes: NDArray[np.complex128],
    spin_orbit_slope: float,
    growth_limit: float,
) -> tuple[FloatArray, FloatArray]: ...
def thermal_conductance_gradient(
    V: FloatArray,
    parameters: FloatArray,
    mu: FloatArray,
    B: FloatArray,
    bias: FloatArray,
    kT: float,
    energies: FloatArray,
    slopes: NDArray[np.complex128],
    spin_orbit_slope: float,
    tolerance: float,
    growth_limit: float,
    roughly: bool,
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]: ...
def isolated_ends(
    V: FloatArray,
    parameters: FloatArray,
    mu: FloatArray,
    B: FloatArray,
    x: FloatArray,
    y: FloatArray,
    theta: float,
) -> ComplexArray: ...
def levels(
    V: FloatArray,
    parameters: FloatArray,
    mu: FloatArray,
    B: FloatArray,
    count: int,
    theta: float,
) -> FloatArray: ...
def local_green(
    V: FloatArray,
    parameters: FloatArray,
    mu: FloatArray,
    B: FloatArray,
    x: FloatArray,
    y: FloatArray,
    leads: ComplexArray,
    theta: float,
) -> tuple[ComplexArray, FloatArray]: ...
def lead_self_energies(
    V: FloatArray, parameters: FloatArray, B: float, omega: FloatArray, theta: float
) -> ComplexArray: ...
def thermal_weights(bias: FloatArray, kT: float, nodes: int) -> FloatArray: ...
def interpolation_weights(u: FloatArray, nodes: int) -> FloatArray: ...
def trigamma(z: ComplexArray) -> ComplexArray: ...
def tilted_poles(
    z: ComplexArray,
    F: ComplexArray,
    sigma: ComplexArray,
    slope: ComplexArray,
    hop: float,
    window: float,
) -> tuple[ComplexArray, ComplexArray]: ...
