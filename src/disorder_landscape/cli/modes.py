"""`landscape modes`: what one wire looks like inside at one chemical potential and field."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from disorder_landscape.cli.options import check_outputs, made_here, wrote
from disorder_landscape.cli.texts import parse_barrier, parse_grid, radians
from disorder_landscape.cli.wire_options import (
    USUAL_BARRIER,
    Alpha,
    Angle,
    Barrier,
    Components,
    CriticalField,
    Delta0,
    Gamma,
    LandeG,
    Lattice,
    LeadMu,
    Mass,
    PotentialFile,
    PotentialSeed,
    Sites,
)
from disorder_landscape.model.parameters import TEMPERATURE, Nanowire

PRINTED = 8
"""Levels that are printed; all are in the file."""


def modes(
    potential: PotentialFile = None,
    seed: PotentialSeed = None,
    components: Components = None,
    sites: Sites = None,
    mass: Mass = Nanowire.mass,
    lattice: Lattice = Nanowire.lattice,
    alpha: Alpha = Nanowire.alpha,
    g: LandeG = Nanowire.g,
    gamma: Gamma = Nanowire.gamma,
    delta0: Delta0 = Nanowire.delta0,
    critical_field: CriticalField = Nanowire.critical_field,
    barrier: Barrier = USUAL_BARRIER,
    lead_mu: LeadMu = Nanowire.lead_mu,
    mu: Annotated[float, typer.Option(help="Chemical potential in meV.")] = 0.0,
    B: Annotated[float, typer.Option("--B", help="Magnetic field in T.")] = 0.6,
    theta: Angle = 0.0,
    count: Annotated[int, typer.Option(help="How many levels.")] = 4,
    energy: Annotated[str, typer.Option(help="Energies of the density of states in meV.")] = (
        "-0.1:0.1:201"
    ),
    temperature: Annotated[
        float, typer.Option(help="Of the density of states in K; 0 is the bare one.")
    ] = TEMPERATURE,
    output: Annotated[Path, typer.Option("--output", "-o", help="netCDF file.")] = Path("modes.nc"),
    plot: Annotated[Path | None, typer.Option(help="Picture.")] = None,
) -> None:
    """Levels, wave functions, Majorana components and local density of states of one wire.

    Energies are a number ("0.03"), a list ("0,0.03") or a range ("start:stop:points").

    Example: landscape modes --seed 1 --mu 0 --B 0.6 -o modes.nc --plot modes.png
    """
    from disorder_landscape import inside_wire, simulation
    from disorder_landscape.dataset.store import write_dataset

    check_outputs(output, plot)
    wire = simulation.chosen_wire(
        potential,
        seed,
        components,
        sites,
        mass=mass,
        lattice=lattice,
        alpha=alpha,
        g=g,
        gamma=gamma,
        delta0=delta0,
        critical_field=critical_field,
        barrier=parse_barrier(barrier),
        lead_mu=lead_mu,
    )
    energies = parse_grid("energy", energy)
    result = inside_wire.look_inside(wire, mu, B, count, energies, temperature, radians(theta))
    write_dataset(result, output, made_here())
    if plot is not None:
        inside_wire.plot_inside(result, plot)
    levels = ", ".join(f"{1e3 * E:.4g}" for E in result.level.to_numpy()[:PRINTED])
    if result.sizes["mode"] > PRINTED:
        levels += ", …"
    overlap = float(result.overlap)
    print(f"levels in µeV: {levels}; overlap of the Majorana components {overlap:.2g}")
    print(wrote(output, plot))
