"""The folder of a trained network.

network.keras (weights and layers), scaler.json, config.json (the run's configuration, the dataset
it was trained on and package versions), metrics.json (scores; written last, it marks a finished
training), curves.csv with curves.pdf and curves.png.
"""

from __future__ import annotations

from pathlib import Path

NETWORK, SCALER, CONFIG, METRICS = "network.keras", "scaler.json", "config.json", "metrics.json"


def is_trained(folder: Path) -> bool:
    """Return whether a folder holds a finished training."""
    return (folder / METRICS).exists()
