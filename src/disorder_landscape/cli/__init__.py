"""The command line: thin; each command reads its options and calls the library."""

from __future__ import annotations

import sys

import typer

from disorder_landscape.arguments import ArgumentError, shown
from disorder_landscape.cli.bench import bench
from disorder_landscape.cli.evaluate import evaluate
from disorder_landscape.cli.generate import generate
from disorder_landscape.cli.infer import infer
from disorder_landscape.cli.modes import modes
from disorder_landscape.cli.predict import predict
from disorder_landscape.cli.simulate import simulate
from disorder_landscape.cli.status import status
from disorder_landscape.cli.study import study
from disorder_landscape.cli.train import train
from disorder_landscape.cli.verify import verify
from disorder_landscape.parts import MissingPartError

app = typer.Typer(
    help="Simulate disordered Majorana nanowires, and read their disorder off their conductance.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
)

for command in (
    simulate,
    modes,
    generate,
    status,
    train,
    evaluate,
    predict,
    infer,
    verify,
    study,
    bench,
):
    app.command()(command)


def main() -> None:
    """Run the command line; what cannot be done is one sentence, and exit code 2."""
    try:
        app()
    except (ArgumentError, MissingPartError) as error:
        print(f"landscape: {error}", file=sys.stderr)
        sys.exit(2)
    except OSError as error:
        if error.filename is None:
            raise
        print(f"landscape: {shown(error.filename)}: {error.strerror}", file=sys.stderr)
        sys.exit(2)
    except MemoryError as error:
        print(f"landscape: there is not enough memory ({error or 'for more'})", file=sys.stderr)
        sys.exit(2)
