"""The types of core/binding.cpp, of which every variant is compiled."""

from disorder_landscape.physics.hamiltonian import ComplexArray
from disorder_landscape.physics.parameters import FloatArray

def instruction_set() -> str: ...
def supported_variants() -> list[str]: ...
def set_threads(count: int) -> None: ...
def real_conductance(
    V: FloatArray,
    parameters: FloatArray,
    mu: FloatArray,
    B: FloatArray,
    omega: FloatArray,
    growth_limit: float,
) -> FloatArray: ...
def complex_conductance(
    V: FloatArray,
    parameters: FloatArray,
    mu: FloatArray,
    B: FloatArray,
    omega: FloatArray,
    growth_limit: float,
) -> FloatArray: ...
def reflection_determinant(
    V: FloatArray,
    parameters: FloatArray,
    mu: FloatArray,
    B: FloatArray,
    omega: FloatArray,
    growth_limit: float,
) -> FloatArray: ...
def tilted_conductance(
    V: FloatArray,
    parameters: FloatArray,
    mu: FloatArray,
    B: FloatArray,
    omega: FloatArray,
    theta: float,
    growth_limit: float,
) -> FloatArray: ...
def tilted_determinant(
    V: FloatArray,
    parameters: FloatArray,
    mu: FloatArray,
    B: FloatArray,
    omega: FloatArray,
    theta: float,
    growth_limit: float,
) -> FloatArray: ...
def tilted_isolated_ends(
    V: FloatArray,
    parameters: FloatArray,
    mu: FloatArray,
    B: FloatArray,
    x: FloatArray,
    y: FloatArray,
    theta: float,
) -> ComplexArray: ...
def tilted_leads(
    V: FloatArray, parameters: FloatArray, B: float, omega: FloatArray, theta: float
) -> ComplexArray: ...
