"""Names and units of everything that goes into a dataset, in one place."""

from __future__ import annotations

import xarray as xr

CONDUCTANCES = ("G_LL", "G_RR", "G_LR", "G_RL")
"""Order of the conductance matrix's elements wherever they share an axis."""
AXES = ("mu", "B", "bias")
"""Order of the axes over which they are measured, the configurations K."""
DRAWN = ("components", "alpha", "potential")
"""What a realization is drawn with, and what a network predicts."""
QUANTITIES = {
    "mu": ("chemical potential", "meV"),
    "B": ("magnetic field", "T"),
    "bias": ("bias voltage", "meV"),
    "lead": ("left or right lead", "1"),
    "realization": ("index of the realization", "1"),
    "component": ("number n of the cosine component", "1"),
    "site": ("lattice site", "1"),
    "G_LL": ("local conductance dI_L/dV_L", "e^2/h"),
    "G_RR": ("local conductance dI_R/dV_R", "e^2/h"),
    "G_LR": ("nonlocal conductance -dI_L/dV_R", "e^2/h"),
    "G_RL": ("nonlocal conductance -dI_R/dV_L", "e^2/h"),
    "error": ("estimated error of the conductances", "e^2/h"),
    "gradient_error": ("estimated error of the derivatives, a share of the largest", "1"),
    "energies": ("energies that the solver was asked for", "1"),
    "energy": ("energy from the Fermi level", "meV"),
    "mode": ("number of the mode, from the lowest level on", "1"),
    "nambu": ("component of the Nambu spinor of Eq. S1", "1"),
    "level": ("energy of the mode", "meV"),
    "wave_function": ("wave function of the mode in the wire, normalised to 1", "1"),
    "wire_weight": ("share of the mode that is in the wire, not in its parent", "1"),
    "majorana_A": ("left Majorana component of the lowest pair, normalised to 1", "1"),
    "majorana_B": ("right Majorana component of the lowest pair, normalised to 1", "1"),
    "separation": ("distance of the Majorana components as a share of the wire", "1"),
    "overlap": ("overlap of the moduli of the Majorana components", "1"),
    "E_1": ("lowest level without leads", "meV"),
    "E_2": ("second level without leads", "meV"),
    "excitation_gap": ("lowest excitation above the zero modes, if there are any", "meV"),
    "transport_gap": ("lowest bias of an appreciable nonlocal conductance", "meV"),
    "LDOS_electron": ("local density of states of electrons, both spins", "1/meV"),
    "LDOS_hole": ("local density of states of holes, both spins", "1/meV"),
    "T_IV": ("topological visibility det r at zero energy", "1"),
    "components": ("disorder components c_1 ... c_n", "meV"),
    "alpha": ("spin-orbit coupling", "meV nm"),
    "potential": ("disorder potential without barriers", "meV"),
    "components_mean": ("mean of the components over the posterior", "meV"),
    "components_std": ("standard deviation of the components", "meV"),
    "potential_mean": ("mean of the disorder potential over the posterior", "meV"),
    "potential_std": ("standard deviation of the disorder potential", "meV"),
    "misfit": ("root-mean-square difference of explained and measured conductances", "e^2/h"),
    "P_topological": ("share of the samples with det r < 0", "1"),
    "share": ("share of the posterior", "1"),
    "potential_maxima": ("potential at the maxima of the posterior", "meV"),
    "gap": ("lowest excitation", "meV"),
    "P_gap": ("share of the samples above this energy", "1"),
    "sample": ("sample of the posterior", "1"),
    "map_mu": ("chemical potential", "meV"),
    "map_B": ("magnetic field", "T"),
}
"""Long name and units of each variable and coordinate."""


def with_units(dataset: xr.Dataset) -> xr.Dataset:
    """Return the dataset with long_name and units on all variables that have them.

    What a name with the ending _predicted stands for is the network's guess of it.
    """
    for name in dataset.variables:
        base = str(name).removesuffix("_predicted")
        if base in QUANTITIES:
            long_name, units = QUANTITIES[base]
            guess = "" if base == name else "predicted "
            dataset[name].attrs.update(long_name=guess + long_name, units=units)
    return dataset
