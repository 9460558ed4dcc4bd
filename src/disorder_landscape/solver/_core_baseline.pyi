"""The types of core/binding.cpp, of which every variant is compiled."""

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
