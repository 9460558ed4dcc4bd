"""`landscape simulate`: conductances and topological visibility of one wire."""

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
    Dissipation,
    Gamma,
    LandeG,
    Lattice,
    LeadMu,
    Mass,
    ParentDissipation,
    PotentialFile,
    PotentialSeed,
    Sites,
)
from disorder_landscape.model.parameters import TEMPERATURE, Nanowire


def simulate(
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
    dissipation: Dissipation = Nanowire.dissipation,
    parent_dissipation: ParentDissipation = None,
    barrier: Barrier = USUAL_BARRIER,
    lead_mu: LeadMu = Nanowire.lead_mu,
    temperature: Annotated[
        float, typer.Option(help="In K; 0 is the bare conductance.")
    ] = TEMPERATURE,
    mu: Annotated[str, typer.Option(help="Chemical potentials in meV.")] = "0",
    B: Annotated[str, typer.Option("--B", help="Magnetic fields in T.")] = "0:0.8:81",
    theta: Angle = 0.0,
    bias: Annotated[str, typer.Option(help="Bias voltages in meV.")] = "-0.04:0.04:81",
    solver: Annotated[str, typer.Option(help="fast, or kwant (the reference).")] = "fast",
    output: Annotated[Path, typer.Option("--output", "-o", help="netCDF file.")] = Path("wire.nc"),
    plot: Annotated[Path | None, typer.Option(help="Picture of a quick look.")] = None,
) -> None:
    """Conductance matrix and topological visibility of one wire.

    Grids are numbers ("0.3"), lists ("0,0.1") or ranges ("start:stop:points").

    Example: landscape simulate --seed 1 --mu 0 --B 0:0.8:81 --bias -0.04:0.04:81 -o wire.nc
    --plot wire.png
    """
    from disorder_landscape import simulation
    from disorder_landscape.dataset.store import write_dataset
    from disorder_landscape.estimates import settings_bar

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
        dissipation=dissipation,
        parent_dissipation=parent_dissipation,
        barrier=parse_barrier(barrier),
        lead_mu=lead_mu,
    )
    texts = {"mu": mu, "B": B, "bias": bias}
    grids = {name: parse_grid(name, text) for name, text in texts.items()}
    angle = radians(theta)
    with settings_bar("simulate") as progress:
        result = simulation.simulate_wire(wire, grids, temperature, solver, angle, progress)
    write_dataset(result, output, made_here())
    if plot is not None:
        simulation.plot_simulation(result, plot)
    V = wire.potential
    print(f"{wire.sites} sites, V from {V.min():.3g} to {V.max():.3g} meV; {wrote(output, plot)}")
