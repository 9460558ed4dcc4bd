"""The command line that all figure scripts share, and the files they write."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import xarray as xr
from matplotlib.figure import Figure

from disorder_landscape.arguments import ArgumentError
from disorder_landscape.chain import evaluation
from disorder_landscape.config import Config
from disorder_landscape.dataset.store import provenance, read_dataset, write_dataset
from disorder_landscape.files import check_writable
from disorder_landscape.model.quantities import DRAWN
from disorder_landscape.pictures import write_picture
from disorder_landscape.runs import FIVE, Run, preset_run
from plotting import paper_style

EVALUATED = [f"{name}{end}" for name in DRAWN for end in ("", "_predicted")]
"""What an evaluation file must hold."""


@dataclass(frozen=True)
class Request:
    """What a figure is asked to show: a run's configuration and test realizations."""

    run: Run
    evaluation_file: Path | None = None
    """Test realizations and predictions to draw instead of the preset's own."""

    @property
    def config(self) -> Config:
        """The run's configuration."""
        return self.run.config

    def evaluation(self) -> xr.Dataset:
        """Return the test realizations and predictions, making first what is missing.

        Returns
        -------
        xarray.Dataset
            components (realization, component) and potential (realization, site) in meV, alpha
            (realization) in meV nm, each also as …_predicted; scores as attributes.
        """
        if self.evaluation_file is not None:
            return read_dataset(self.evaluation_file, EVALUATED)
        return evaluation(self.run)


def figure_script(
    path: str,
    data: Callable[[Request], xr.Dataset],
    draw: Callable[[xr.Dataset], Figure],
    description: str,
    arguments: Sequence[str] | None = None,
    preset: str = "small",
    model: str = FIVE,
) -> None:
    """Run one figure's script: figure_3_….py writes figure_3.nc, figure_3.pdf and figure_3.png.

    Parameters
    ----------
    path : str
        The script's own.
    data : callable
        Makes all that is drawn.
    draw : callable
        Draws it, from these data alone.
    description : str
        For --help.
    arguments : sequence of str, optional
        The command line; by default the process's.
    preset : str
        Preset to draw if none is named.
    model : str
        Which of the paper's two models it shows, as in `runs.preset_run`.
    """
    script = Path(path).name
    name = "_".join(script.split("_")[:2])
    options = _parse(script, description, preset, arguments)
    try:
        paths = {ending: options.output / f"{name}.{ending}" for ending in ("pdf", "png", "nc")}
        for one in paths.values():
            check_writable("output", one)
        request = Request(preset_run(options.preset, model=model), options.evaluation)
        drawn = data(request)
        command = f"python paper_figures/{script} --preset {options.preset}"
        if options.evaluation is not None:
            command += f" --evaluation {options.evaluation}"
        attrs = {**provenance(command), "preset": options.preset}
        with paper_style():
            figure = draw(drawn)
            for ending in ("pdf", "png"):
                _save(figure, paths[ending])
        write_dataset(drawn, paths["nc"], attrs)  # last: the report takes its command from it
    except ArgumentError as error:
        print(f"{script}: {error}", file=sys.stderr)
        sys.exit(2)
    print(f"wrote {options.output / name}.pdf, .png and .nc (the plotted arrays)")


def _parse(
    script: str, description: str, preset: str, arguments: Sequence[str] | None
) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog=script,
        description=description,
        epilog=f"example: python paper_figures/{script} --preset {preset} --output build/figures",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--preset",
        default=preset,
        help="run to draw: a name in configs/, or shipped (default: %(default)s); "
        "what is missing of it is made first",
    )
    parser.add_argument(
        "--output",
        type=Path,
        default=Path("build/figures"),
        metavar="FOLDER",
        help="where to write PDF, PNG and netCDF (default: %(default)s)",
    )
    parser.add_argument(
        "--evaluation",
        type=Path,
        metavar="FILE",
        help="draw these test realizations and predictions (an evaluation.nc) "
        "instead of the preset's",
    )
    return parser.parse_args(arguments)


def _save(figure: Figure, path: Path) -> None:
    """Write a picture; the same figure gives the same bytes."""
    no_date = {"CreationDate": None} if path.suffix == ".pdf" else {}
    write_picture(path, figure, metadata=no_date)
