"""What `landscape modes` does: collect what a wire looks like inside, and draw it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray as xr

from disorder_landscape.model.disorder import positions
from disorder_landscape.model.parameters import FloatArray, Nanowire
from disorder_landscape.model.quantities import with_units
from disorder_landscape.model.stated import stated
from disorder_landscape.observables.density_of_states import local_density_of_states
from disorder_landscape.observables.modes import modes
from disorder_landscape.parts import needs
from disorder_landscape.pictures import write_picture


def look_inside(
    wire: Nanowire,
    mu: float,
    B: float,
    count: int,
    energy: FloatArray,
    temperature: float,
    theta: float,
) -> xr.Dataset:
    """Return modes, local density of states and potential of a wire in one dataset of real numbers.

    Parameters
    ----------
    wire, mu, B, count, theta
        As in `modes`.
    energy, temperature
        As in `local_density_of_states`.

    Returns
    -------
    xarray.Dataset
        Of both; what is complex has a last dim `part`, real and imaginary, since netCDF knows no
        complex numbers.
    """
    found = modes(wire, mu, B, count, theta)
    result = found.map(_in_parts).assign_coords(part=["real", "imaginary"])
    density = local_density_of_states(wire, mu, B, energy, temperature, theta)
    for name, variable in density.isel(mu=0, B=0, drop=True).data_vars.items():
        result[name] = variable
    result["potential"] = ("site", wire.potential)
    attrs = {**found.attrs, **stated([wire]), "temperature": temperature}
    return with_units(result.assign_attrs(attrs))


def _in_parts(variable: xr.DataArray) -> xr.DataArray:
    if not np.iscomplexobj(variable):
        return variable
    return xr.concat([variable.real, variable.imag], "part").transpose(..., "part")


@needs("figures")
def plot_inside(result: xr.Dataset, path: Path) -> None:
    """Draw potential, local density of states and the Majorana components over the wire.

    Raises
    ------
    ArgumentError
        If the file cannot be written.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(5, 6), layout="constrained")
    above, middle, below = figure.subplots(3, 1, sharex=True, height_ratios=(1, 2, 1))
    x = positions(result.sizes["site"], result.attrs["lattice"])
    above.plot(x, result.potential, "k-", lw=1)
    above.set_ylabel("$V$ [meV]")
    above.set_title(f"µ = {result.attrs['mu']:g} meV, B = {result.attrs['B']:g} T", loc="left")
    density = result.LDOS_electron + result.LDOS_hole
    if result.sizes["energy"] > 1:
        energy = 1e3 * result.energy
        drawn = middle.pcolormesh(x, energy, density, cmap="magma", vmin=0, rasterized=True)
        label = "LDOS [1/meV per site]"
        figure.colorbar(drawn, ax=middle, label=label, pad=0.01)
        levels = 1e3 * np.concatenate([result.level, -result.level])
        seen = levels[(levels >= energy.min().item()) & (levels <= energy.max().item())]
        middle.hlines(seen, 0.98 * x[-1], x[-1], "w", lw=1.5)
        middle.set_ylabel("energy [µeV]")
        middle.set_title("white at the right: levels without leads", loc="left", fontsize=8)
    else:
        middle.plot(x, density[0], "k-", lw=1)
        middle.set_ylabel("LDOS [1/meV per site]")
    for letter, colour in (("A", "C0"), ("B", "C3")):
        weight = (result[f"majorana_{letter}"] ** 2).sum(("nambu", "part"))
        below.plot(x, weight, colour, lw=1, label=rf"$|\gamma_{letter}|^2$")
    below.set_title(
        rf"$E_1$ = {1e3 * float(result.level[0]):.3g} µeV, overlap {float(result.overlap):.2g}",
        loc="left",
    )
    below.set_ylabel("per site")
    below.set_xlabel("$x$ [µm]")
    below.legend(frameon=False)
    write_picture(path, figure, dpi=150)
