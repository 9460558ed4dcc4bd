"""Figure S6: Figure S5 for ten disorder components, the realizations of Figure S4.

Conductance over μ and field at V_bias = 0: input wire above, below the one with the disorder that
the network predicts; α = 8 meV nm is fixed and known.
"""

from __future__ import annotations

from collections.abc import Sequence

from command import figure_script
from disorder_landscape.runs import TEN
from figure_S5_conductance_mu import data, draw


def main(arguments: Sequence[str] | None = None) -> None:
    """Make the figure's files."""
    figure_script(__file__, data, draw, __doc__ or "", arguments, model=TEN)


if __name__ == "__main__":
    main()
