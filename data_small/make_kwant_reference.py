"""Make kwant_reference.nc: T = 0 conductances and T_IV of a handful of wires, by Kwant.

Run from the repository's root: python data_small/make_kwant_reference.py (about a minute).
"""

from pathlib import Path

import numpy as np
import xarray as xr
from tqdm import tqdm

from disorder_landscape import Nanowire, conductance, topological_visibility
from disorder_landscape.dataset.store import provenance, write_dataset
from disorder_landscape.model.disorder import disorder_realization
from disorder_landscape.model.parameters import SITES
from disorder_landscape.model.quantities import with_units

SEED = 2024
GRID = {"mu": [0.0, 0.15, 0.45], "B": [0.0, 0.25, 0.5, 0.8], "bias": [-0.04, -0.01, 0.0, 0.025]}


def wires() -> list[Nanowire]:
    """Return a pristine wire, two of 5, two of 10 and one of 30 disorder components."""
    drawn = [Nanowire(np.zeros(SITES))]
    for index, components in enumerate([5, 5, 10, 10, 30]):
        rng = np.random.default_rng([SEED, index])
        alpha = rng.uniform(6.4, 9.6)
        drawn.append(Nanowire(disorder_realization(rng, components, SITES)[1], alpha=alpha))
    return drawn


def main() -> None:
    """Simulate and write."""
    parts = []
    for wire in tqdm(wires(), unit=" wires"):
        part = conductance(wire, **GRID, temperature=0, solver="kwant")
        part["T_IV"] = topological_visibility(wire, GRID["mu"], GRID["B"], solver="kwant")
        part["potential"] = ("site", wire.potential)
        part["alpha"] = wire.alpha
        parts.append(part)
    reference = with_units(xr.concat(parts, "realization"))
    attrs = {**provenance("python data_small/make_kwant_reference.py"), "seed": SEED}
    write_dataset(reference, Path(__file__).parent / "kwant_reference.nc", attrs)


if __name__ == "__main__":
    main()
