"""The options of commands that make one wire."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from disorder_landscape.model.parameters import COMPONENTS, SITES, Nanowire

PotentialFile = Annotated[
    Path | None,
    typer.Option(help="V_dis per site in meV: .csv (a line each), .npy or .nc (potential)."),
]
PotentialSeed = Annotated[
    int | None, typer.Option(min=0, help="Draw the potential with this seed instead.")
]
Components = Annotated[
    int | None,
    typer.Option(
        help=f"Disorder components of a drawn potential; 0: pristine.  [default: {COMPONENTS}]"
    ),
]
Sites = Annotated[
    int | None,
    typer.Option(help=f"Sites of the wire.  [default: those of the file, or {SITES}]"),
]
Mass = Annotated[float, typer.Option(help="Effective mass in electron masses.")]
Lattice = Annotated[float, typer.Option(help="Lattice spacing in nm.")]
LeadMu = Annotated[float, typer.Option(help="Chemical potential of the leads in meV.")]
Alpha = Annotated[float, typer.Option(help="Spin-orbit coupling in meV nm.")]
LandeG = Annotated[float, typer.Option("--g", help="Lande g-factor.")]
Gamma = Annotated[float, typer.Option(help="Coupling to the superconductor in meV.")]
Delta0 = Annotated[float, typer.Option(help="Gap of the superconductor in meV.")]
CriticalField = Annotated[
    float, typer.Option(help="Field in T at which this gap closes, as sqrt(1 - (B/Bc)^2).")
]
Dissipation = Annotated[
    float, typer.Option(help="Broadening of all levels in meV; with it there is no T_IV.")
]
ParentDissipation = Annotated[
    float | None,
    typer.Option(help="The same of the superconductor in meV.  [default: the wire's]"),
]
Barrier = Annotated[
    str, typer.Option(help="Barrier on the end sites in meV: one number, or left,right.")
]
Angle = Annotated[
    float, typer.Option("--theta", help="Angle of the field relative to the wire in degrees.")
]
USUAL_BARRIER = ",".join(f"{one:g}" for one in dict.fromkeys(Nanowire.barrier))
