# ---
# jupyter:
#   jupytext:
#     text_representation:
#       format_name: percent
# ---

# %% [markdown]
# # From a measurement to the disorder in the wire
#
# A file holds the four conductances of one nanowire over μ, B and V_bias, measured with an error of
# 0.01 e²/h. What is the disorder in the wire, how sure is that, and where is the wire topological?
#
# To open this as a notebook: `jupytext --to ipynb notebooks/from_measurement_to_disorder.py`.

# %%
from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib import pyplot as plt

import disorder_landscape as dl

here = Path.cwd()
DATA = next(p / "data_small" for p in (here, *here.parents) if (p / "data_small").exists())
MODEL = DATA / "models" / "five_components_and_alpha_noisy"
measured = xr.load_dataset(DATA / "measurement.nc", engine="h5netcdf")
print(measured)

# %% [markdown]
# ## The network's guess
#
# This is where the paper stops. This network was trained with errors of up to 0.1 e²/h.

# %%
guess = dl.predict(MODEL, measured)
print("α =", float(guess["alpha"]), "meV nm")

# %% [markdown]
# ## The answer
#
# Gauss–Newton steps start at the guess and at draws from its error, and must agree. If they do not,
# rounds of simulation and regression bring the guess nearer.

# %%
inferred = dl.infer(measured, MODEL)  # with the noise that the file states
print(inferred.attrs["verdict"], "after", inferred.attrs["rounds"], "rounds")
for channel, misfit in zip(inferred["channel"].values, inferred["misfit"].values, strict=True):
    print(f"misfit of {channel}: {misfit:.4f} e²/h")

# %% [markdown]
# Because this measurement was simulated, the truth is in the file, and both can be judged.

# %%
true = measured["true_potential"]
for name, V in (("network", guess["potential"]), ("inversion", inferred["potential_mean"])):
    error = 1e3 * np.sqrt(((V - true) ** 2).mean())
    print(f"{name}: V off by {float(error):.2f} µeV, root mean square over the sites")
own = 1e3 * np.sqrt((inferred["potential_std"] ** 2).mean())
print(f"error bar of the inversion: {float(own):.2f} µeV")

# %%
figure, (top, bottom) = plt.subplots(2, 1, sharex=True, figsize=(7, 4), layout="constrained")
top.plot(true, "k", lw=2, label="true")
top.plot(guess["potential"], "C1--", label="network")
top.plot(inferred["potential_mean"], "C0", lw=1, label="inversion")
top.set_ylabel("V [meV]")
top.legend(frameon=False)
bottom.plot(1e3 * (inferred["potential"] - true).T, "C0", lw=0.3, alpha=0.5)
bottom.axhline(0, color="k", lw=0.5)
bottom.set(xlabel="site", ylabel="samples − true [µeV]")

# %% [markdown]
# ## Where is it topological?
#
# The share of the samples whose T_IV = det r is negative, at each μ and B.

# %%
P = inferred["P_topological"]
figure, panel = plt.subplots(figsize=(4, 3), layout="constrained")
P.plot.pcolormesh(x="map_B", y="map_mu", ax=panel, vmin=0, vmax=1, cmap="Purples")
certain = float(((P == 0) | (P == 1)).mean())
print(f"all samples agree at {100 * certain:.0f} % of the points")
