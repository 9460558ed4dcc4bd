"""`landscape simulate`: conductances and topological visibility of one wire."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

import typer

from disorder_landscape.arguments import number_in
from disorder_landscape.cli.options import made_here
from disorder_landscape.cli.wire_options import (
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
from disorder_landscape.model.parameters import Nanowire


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
    barrier: Barrier = "15",
    lead_mu: LeadMu = Nanowire.lead_mu,
    temperature: Annotated[float, typer.Option(help="In K; 0 is the bare conductance.")] = 0.05,
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
    from tqdm import tqdm

    from disorder_landscape import simulation
    from disorder_landscape.dataset.store import write_dataset

    simulation.check_outputs(output, plot)
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
        barrier=simulation.parse_barrier(barrier),
        lead_mu=lead_mu,
    )
    angle = math.radians(number_in("theta", theta, -360.0, 360.0, "degrees"))
    grids = {
        name: simulation.parse_grid(name, text)
        for name, text in {"mu": mu, "B": B, "bias": bias}.items()
    }
    with tqdm(unit=" settings", delay=1, desc="simulate") as bar:

        def progress(done: int, in_all: int) -> None:
            bar.total = in_all
            bar.update(done)

        result = simulation.simulate_wire(wire, grids, temperature, solver, angle, progress)
    write_dataset(result, output, made_here())
    if plot is not None:
        simulation.plot_simulation(result, plot)
    print(f"{wire.sites} sites; wrote {output}" + (f" and {plot}" if plot else ""))
