"""Make measurement.nc: what a measurement of a wire with hidden disorder looks like, and its truth.

Run from the repository's root: python data_small/make_measurement.py (seconds).
"""

from pathlib import Path

import numpy as np

from disorder_landscape import conductance
from disorder_landscape.dataset.realizations import realization
from disorder_landscape.dataset.store import provenance, write_dataset
from disorder_landscape.learning.model import load_model_config
from disorder_landscape.model.quantities import CONDUCTANCES, QUANTITIES
from disorder_landscape.runs import FIVE, shipped_model

SEED, INDEX = 2026, 1
"""Of the wire, which is none of any dataset."""
NOISE = 0.01
"""Of the measured conductances in e²/h."""


def main() -> None:
    """Simulate, add errors and write."""
    config = load_model_config(shipped_model(FIVE)).dataset.model_copy(update={"seed": SEED})
    true = realization(config, INDEX)
    measured = conductance(true.wire, config.mu, config.B, config.bias)
    measured = measured.drop_vars(["error", "energies"])
    rng = np.random.default_rng(SEED)
    for name in CONDUCTANCES:
        G = measured[name] + NOISE * rng.normal(size=measured[name].shape)
        measured[name] = G.astype(np.float32).assign_attrs(measured[name].attrs)
    for name, dims, value in (("potential", "site", true.potential), ("alpha", (), true.alpha)):
        long_name, units = QUANTITIES[name]
        attrs = {"long_name": f"{long_name}, which no experiment would know", "units": units}
        measured[f"true_{name}"] = (dims, value, attrs)
    attrs = {**provenance("python data_small/make_measurement.py"), "seed": SEED, "noise": NOISE}
    write_dataset(measured, Path(__file__).parent / "measurement.nc", attrs)


if __name__ == "__main__":
    main()
