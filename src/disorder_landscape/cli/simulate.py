"""`landscape simulate`: conductances and topological visibility of one wire."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

import typer

from disorder_landscape.arguments import number_in, require
from disorder_landscape.cli.options import made_here


def simulate(
    potential: Annotated[
        Path | None, typer.Option(help="V_dis per site in meV: .csv, .npy or .nc file.")
    ] = None,
    seed: Annotated[
        int | None, typer.Option(min=0, help="Draw the potential with this seed instead.")
    ] = None,
    components: Annotated[
        int, typer.Option(help="Disorder components of a drawn potential; 0: pristine.")
    ] = 5,
    sites: Annotated[int, typer.Option(help="Sites of the wire, 10 nm each.")] = 300,
    alpha: Annotated[float, typer.Option(help="Spin-orbit coupling in meV nm.")] = 8.0,
    g: Annotated[float, typer.Option(help="Lande g-factor.")] = 25.0,
    gamma: Annotated[float, typer.Option(help="Coupling to the superconductor in meV.")] = 0.15,
    delta0: Annotated[float, typer.Option(help="Gap of the superconductor in meV.")] = 0.12,
    barrier: Annotated[
        str, typer.Option(help="Barrier on the end sites in meV: one number, or left,right.")
    ] = "15",
    temperature: Annotated[float, typer.Option(help="In K; 0 is the bare conductance.")] = 0.05,
    mu: Annotated[str, typer.Option(help="Chemical potentials in meV.")] = "0",
    B: Annotated[str, typer.Option("--B", help="Magnetic fields in T.")] = "0:0.8:81",
    theta: Annotated[
        float, typer.Option(help="Angle of the field relative to the wire in degrees.")
    ] = 0.0,
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
    import numpy as np
    from tqdm import tqdm

    from disorder_landscape import simulation
    from disorder_landscape.dataset.store import write_dataset
    from disorder_landscape.files import check_netcdf, check_writable
    from disorder_landscape.model.disorder import disorder_realization
    from disorder_landscape.model.parameters import Nanowire

    check_netcdf("output", output)
    if plot is not None:
        simulation.check_plot(plot)
        check_writable("plot", plot)
    both = "one of --potential and --seed at most"
    require(potential is None or seed is None, "potential", f"come with {both}", "both are given")
    require(sites >= 2, "sites", "be 2 or more", f"it is {sites}")
    must = f"be from 0 to {sites - 1}"
    require(0 <= components < sites, "components", must, f"it is {components}")
    if potential is not None:
        V = simulation.read_potential(potential, sites)
    elif seed is None or components == 0:
        V = np.zeros(sites)
    else:
        V = disorder_realization(np.random.default_rng(seed), components, sites)[1]
    barriers = simulation.parse_barrier(barrier)
    wire = Nanowire(V, alpha=alpha, g=g, gamma=gamma, delta0=delta0, barrier=barriers)
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
    print(f"wrote {output}" + (f" and {plot}" if plot else ""))
