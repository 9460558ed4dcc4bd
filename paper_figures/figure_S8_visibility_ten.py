"""Figure S8: Figure S7 for ten disorder components, the realizations of Figure S4.

Topological visibility T_IV over μ and field, input above and prediction below; the dotted line is
the cut at μ = 0 whose conductance Figure S4 shows.
"""

from __future__ import annotations

from collections.abc import Sequence

from command import figure_script
from disorder_landscape.runs import TEN
from figure_S7_visibility import data, draw


def main(arguments: Sequence[str] | None = None) -> None:
    """Make the figure's files."""
    figure_script(__file__, data, draw, __doc__ or "", arguments, model=TEN)


if __name__ == "__main__":
    main()
