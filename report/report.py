# ---
# jupyter:
#   jupytext:
#     text_representation:
#       extension: .py
#       format_name: percent
# ---

# %% [markdown]
# # The disorder landscape of Majorana nanowires: a reproduction, claim by claim
#
# Taylor, Sau and Das Sarma, *Machine Learning the Disorder Landscape of Majorana Nanowires*,
# [Phys. Rev. Lett. **132**, 206602 (2024)](https://doi.org/10.1103/PhysRevLett.132.206602), train a
# convolutional network to read a nanowire's disorder potential and spin–orbit coupling off its
# conductance. This page holds what came out when we did all of it again: every number and every
# checkable sentence of the paper with ours beside it, the figures, and the choices that the paper
# leaves open.
#
# [Claims](#claims) · [Figures](#figures) · [Inversion](#inversion) ·
# [Studies](#studies) · [Conventions](#conventions) ·
# [Limitations](#limitations) · [Do it yourself](#again)

# %%
# ruff: noqa: D100 (this is a notebook)
from pieces import (
    claims_summary,
    claims_table,
    document,
    drawn_figures,
    stored_results,
)

claims_summary()

# %% [markdown]
# <h2 id="claims">Claims</h2>
#
# "Accepted" is which values of ours count as reproducing the paper's. Where the paper has words
# only, it is what we ask for instead, chosen before we measured. A claim may have several values of
# ours, at different sizes or in different readings of the paper; the first decides.

# %%
claims_table()

# %%
stored_results()

# %% [markdown]
# <h2 id="figures">Figures</h2>
#
# Numbered as in the paper. Minutes are on two cores, once the network is there.

# %%
drawn_figures()

# %% [markdown]
# <h2 id="inversion">Beyond the paper: from a measurement to the disorder, with error bars</h2>

# %%
document("infer")

# %%
document("inversion")

# %% [markdown]
# <h2 id="studies">Studies</h2>

# %%
document("studies")

# %% [markdown]
# <h2 id="conventions">Conventions</h2>

# %%
document("conventions")

# %% [markdown]
# <h2 id="limitations">Limitations</h2>

# %%
document("limits")

# %% [markdown]
# <h2 id="again">Do it yourself</h2>
#
# From the repository's root, on Debian or Ubuntu with Python 3.11 to 3.13, make and gcc:
#
# - `make figures` simulates the wires, trains the network and draws the figures;
# - `make claims` measures again what is quick and checks the rest against stored results;
# - `make report` writes this page.
#
# `make docs` builds the documentation, which tells the rest. The claims stand in
# `results/claims.toml`, the studies and their results in `results/`, the figures' scripts in
# `paper_figures/`, this page's source in `report/`.
