"""Units, constants and the nanowire with the paper's default parameters.

Energies are in meV, lengths in nm, fields in T, temperatures in K, conductances in e²/h.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy.constants import e, hbar, m_e, physical_constants

from disorder_landscape.arguments import number_in, require
from disorder_landscape.model.ranges import (
    FOLLOWING,
    PARAMETER_RANGES,
    checked_barrier,
    checked_potential,
)

FloatArray = NDArray[np.float64]

HBAR2_OVER_2ME: float = hbar**2 / (2 * m_e) / (1e-3 * e) * 1e18
"""ħ²/2mₑ in meV nm²."""
BOHR_MAGNETON: float = 1e3 * physical_constants["Bohr magneton in eV/T"][0]
"""μ_B in meV/T."""
BOLTZMANN: float = 1e3 * physical_constants["Boltzmann constant in eV/K"][0]
"""k_B in meV/K."""

MOST_SITES = 100_000
"""Most sites of a wire that a command or a configuration makes."""
SITES = 300
"""Sites of the paper's 3 µm wire at a = 10 nm (S-I)."""
COMPONENTS = 5
"""Kept of the disorder: the smaller one of the paper's two numbers (S-II.1)."""
ALPHA = 8.0
"""Nominal spin–orbit coupling in meV nm (S-I)."""
ALPHA_RANGE = (6.4, 9.6)
"""Range of the uniform distribution of α in meV nm (S-II.1)."""
TEMPERATURE = 0.05
"""Temperature in K (S-I)."""
BIAS = (-0.04, -0.02, 0.0, 0.02, 0.04)
"""The five bias values in meV (S-II.1)."""
MU_MAX = 0.6
"""Largest chemical potential of the grid in meV (S-II.1)."""
B_MAX = 0.8
"""Largest magnetic field of the grid in T (S-II.1)."""
NOISE_FLOOR = 0.001
"""Error of a measured conductance in e²/h, the least that the paper's main text reckons with."""


@dataclass(frozen=True, eq=False)
class Nanowire:
    """A disordered Majorana nanowire between two normal leads (paper, S-I).

    Parameters
    ----------
    potential : array_like, shape (site,)
        V_dis(x) in meV, without the barriers; at least two sites.
    alpha : float
        Spin–orbit coupling α in meV nm.
    mass : float
        Effective mass m* in units of the electron's.
    lattice : float
        Lattice spacing a in nm.
    g : float
        Landé g-factor, without its sign: that turns the field.
    gamma : float
        Coupling γ to the parent superconductor in meV (self-energy below Eq. S1).
    delta0 : float
        Gap Δ₀ of the parent superconductor in meV.
    barrier : tuple of two floats
        V_Barrier on the first and on the last site, in meV (S-II.1).
    lead_mu : float
        Chemical potential of the leads in meV, a convention of the group's published codes. Beyond
        their band, which is from 0 to 4ħ²/2m*a², nothing conducts.
    lead_alpha : float or None
        Spin–orbit coupling of the leads in meV nm; None takes the wire's.
    lead_g : float or None
        Landé g-factor of the leads; None takes the wire's.
    critical_field : float
        B_c in T: the parent's gap in a field is Δ₀√(1 − (B/B_c)²), as that of an aluminium shell
        is. The paper's does not depend on the field.
    dissipation : float
        Γ ≥ 0 in meV: ω + iΓ in place of ω broadens the levels, as if each leaked into a bath that
        takes no part in transport (Dynes et al., PRL 41, 1509). The paper's wires have none.
    parent_dissipation : float or None
        The same of the parent superconductor, in Σ(ω + iΓ); None takes the wire's. With 0 the wire
        alone leaks, by −iΓ on each site, as in Liu, Sau and Das Sarma, PRB 95, 054502.

    Raises
    ------
    ArgumentError
        If the potential is not a finite vector, or a parameter is out of its range.
    """

    potential: FloatArray = field(repr=False)
    alpha: float = ALPHA
    mass: float = 0.03
    lattice: float = 10.0
    g: float = 25.0
    gamma: float = 0.15
    delta0: float = 0.12
    barrier: tuple[float, float] = (15.0, 15.0)
    lead_mu: float = 25.0
    lead_alpha: float | None = None
    lead_g: float | None = None
    critical_field: float = np.inf
    dissipation: float = 0.0
    parent_dissipation: float | None = None

    def __post_init__(self) -> None:
        checked: dict[str, object] = {"potential": checked_potential(self.potential)}
        for name, (low, high, unit) in PARAMETER_RANGES.items():
            value = getattr(self, name)
            if not (value is None and name in FOLLOWING):
                checked[name] = number_in(name, value, low, high, unit)
        checked["barrier"] = checked_barrier(self.barrier)
        for name, value in checked.items():
            object.__setattr__(self, name, value)

    def in_field(self, B: float) -> Nanowire:
        """Return the wire with the gap that its parent has in a field, in T.

        Raises
        ------
        ArgumentError
            If there is none left.
        """
        if np.isinf(self.critical_field):
            return self
        left = gap_in_field(self.delta0, self.critical_field, B)
        least = PARAMETER_RANGES["delta0"][0]
        must = f"stay below the critical field of {self.critical_field:g} T, where the gap closes"
        but = f"at {B:g} T it is less than {least:g} meV"
        require(left >= least, "B", must, but)
        return replace(self, delta0=left, critical_field=np.inf)

    @property
    def sites(self) -> int:
        """Number of sites."""
        return len(self.potential)

    @property
    def length(self) -> float:
        """In µm."""
        return self.sites * self.lattice / 1000

    @property
    def hopping(self) -> float:
        """Hopping t = ħ²/2m*a² in meV."""
        return hopping(self.mass, self.lattice)

    @property
    def spin_orbit_hopping(self) -> float:
        """α/2a in meV."""
        return self.alpha / (2 * self.lattice)

    @property
    def rotated_hopping(self) -> float:
        """Hopping t' = √(t² + (α/2a)²) in meV where the spin turns (core/wire/elimination.hpp)."""
        return float(np.hypot(self.hopping, self.spin_orbit_hopping))

    @property
    def lead_spin_orbit_hopping(self) -> float:
        """α/2a of the leads in meV."""
        alpha = self.alpha if self.lead_alpha is None else self.lead_alpha
        return alpha / (2 * self.lattice)

    @property
    def zeeman_per_tesla(self) -> float:
        """V_Z/B = ½gμ_B in meV/T."""
        return 0.5 * self.g * BOHR_MAGNETON

    @property
    def lead_zeeman_per_tesla(self) -> float:
        """V_Z/B of the leads in meV/T."""
        return 0.5 * (self.g if self.lead_g is None else self.lead_g) * BOHR_MAGNETON

    @property
    def dissipation_of_parent(self) -> float:
        """Γ of the parent superconductor in meV."""
        own = self.parent_dissipation
        return self.dissipation if own is None else own

    @property
    def lossless(self) -> bool:
        """Whether neither the wire nor its parent has dissipation."""
        return self.dissipation == 0 and self.dissipation_of_parent == 0

    @property
    def potential_with_barriers(self) -> FloatArray:
        """V_dis plus the barriers on the two end sites, shape (site,), in meV."""
        V = self.potential.copy()
        V[0] += self.barrier[0]
        V[-1] += self.barrier[1]
        return V


def gap_in_field(delta0: float, critical_field: float, B: float) -> float:
    """Return Δ₀√(1 − (B/B_c)²) in meV, the gap of the parent in a field; zero beyond B_c."""
    return delta0 * float(np.sqrt(max(0.0, 1 - (B / critical_field) ** 2)))


def hopping(mass: float, lattice: float) -> float:
    """Return the hopping t = ħ²/2m*a² in meV, of electron masses and nm."""
    return HBAR2_OVER_2ME / (mass * lattice**2)


def check_leads(lead_mu: float, mass: float, lattice: float) -> None:
    """Require that the leads' chemical potential is within their band.

    Raises
    ------
    ArgumentError
        If it is not: then no mode propagates in them, but for spin splitting, and nothing conducts.
    """
    width = 4 * hopping(mass, lattice)
    must = f"be within the leads' band, from 0 to {width:.3g} meV, for anything to conduct"
    but = f"it is {lead_mu:g}"
    if lead_mu >= width:
        but += " (a smaller lattice spacing makes the band wider)"
    require(0 < lead_mu < width, "lead_mu", must, but)
