"""`landscape evaluate`: the scores of a run's network."""

from __future__ import annotations

from pathlib import Path

from disorder_landscape.cli.options import Build, ConfigFile
from disorder_landscape.parts import needs


@needs("learning")
def evaluate(config: ConfigFile, build: Build = Path("build")) -> None:
    """Score the network of a run on its test realizations.

    Example: landscape evaluate --config configs/small.toml
    """
    from disorder_landscape import chain, runs

    run = runs.open_run(config, build)
    scores = chain.evaluate(run).attrs
    print(f"R2 (standard-scaled)  {scores['R2']:.4f}")
    print(f"dV_dis(x_i)           {scores['delta_V']:.4f} meV")
    if "delta_alpha" in scores:
        print(f"d alpha               {scores['delta_alpha']:.4f} meV nm")
    if "delta_mean" in scores:
        print(f"d mean of V           {scores['delta_mean']:.4f} meV")
    for name, value in scores.items():
        if name.startswith("R2_"):
            print(f"R2 of {name.removeprefix('R2_'):8s}        {value:.4f}")
    print(f"wrote {run.evaluation_file}")
