"""Files of pictures, in the formats that matplotlib knows."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from disorder_landscape.arguments import require
from disorder_landscape.files import check_writable, replacing
from disorder_landscape.parts import needs

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@needs("figures")
def picture_formats() -> list[str]:
    """Return the endings of pictures, without their dots."""
    from matplotlib.backend_bases import FigureCanvasBase

    return [kind for kind in FigureCanvasBase.get_supported_filetypes() if kind != "pgf"]  # LaTeX's


def check_picture(name: str, path: Path, others: Sequence[str] = ()) -> None:
    """Raise an ArgumentError where a picture could not be written, or has no picture's ending.

    Endings of `others` are accepted, too.
    """
    formats = [*picture_formats(), *others]
    must = f"end in one of {', '.join(formats)}"
    require(path.suffix.removeprefix(".") in formats, name, must, f"it is '{path}'")
    check_writable(name, path)


def write_picture(path: Path, figure: Figure, **options: Any) -> None:
    """Write a figure in the format that the path's ending names; options are those of savefig."""
    # In memory first: Matplotlib complains on its own where the disk is full.
    content = picture(figure, path.suffix.removeprefix("."), **options)
    with replacing(path) as temporary:
        temporary.write_bytes(content)


def picture(figure: Figure, kind: str, **options: Any) -> bytes:
    """Return a figure in a format; options are those of savefig."""
    content = io.BytesIO()
    figure.savefig(content, format=kind, **options)
    return content.getvalue()
