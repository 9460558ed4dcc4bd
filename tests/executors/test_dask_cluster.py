"""A Dask cluster: the same bytes as locally, though a worker is killed."""

from __future__ import annotations

import os
import signal

import pytest

from disorder_landscape import ArgumentError
from disorder_landscape.config import DatasetConfig
from disorder_landscape.dataset import shards
from disorder_landscape.executors.dask_cluster import DaskCluster

CONFIG = DatasetConfig(realizations=60, sites=60, mu_points=8, B_points=8, shard_size=5)


def test_a_scheduler_that_is_not_there_is_one_sentence(monkeypatch):
    monkeypatch.setattr("disorder_landscape.executors.dask_cluster.ANSWERS_WITHIN", 1)
    with pytest.raises(ArgumentError, match="scheduler must be the address of a Dask scheduler"):
        _ = DaskCluster("tcp://127.0.0.1:1").at_a_time


@pytest.mark.slow
@pytest.mark.filterwarnings("default")  # of Dask about its lost worker
def test_a_killed_worker_loses_nothing(tmp_path):
    from distributed import LocalCluster

    with LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address=None, host="127.0.0.1"
    ) as cluster:
        executor = DaskCluster(cluster.scheduler_address)
        assert executor.at_a_time == 2
        made = 0

        def progress(realizations):
            nonlocal made
            if made == 0:
                os.kill(next(iter(cluster.workers.values())).pid, signal.SIGKILL)
            made += realizations

        shards.generate(CONFIG, tmp_path / "dask", executor, progress)
    assert made == 60
    shards.generate(CONFIG, tmp_path / "local")
    here, there = (sorted((tmp_path / of).iterdir()) for of in ("local", "dask"))
    assert [path.read_bytes() for path in here] == [path.read_bytes() for path in there]
