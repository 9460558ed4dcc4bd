"""Jobs of Slurm: arrays of the very command, each job with a share of the tasks (`Share`).

A job is a plain shell script; what it makes is in files, by which whoever waits knows how far all
have come. So nothing is lost with the process that waits, and no job needs to know of another.
"""

from __future__ import annotations

import shlex
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from tqdm import tqdm

from disorder_landscape.arguments import ArgumentError, require
from disorder_landscape.executors.site import Site
from disorder_landscape.files import read_json, write_json

JOBS = "jobs.json"
"""In the folder of a command's jobs: which they are."""
MOST_IN_ARRAY = 1000
"""Of jobs in an array, where Slurm does not say: its own default."""
ASKED_EVERY = 5.0
"""Seconds between two looks at the jobs, and …"""
LOOKING = 0.05
"""… the most of the time that looking may take."""


def jobs_folder(build: Path, name: str) -> Path:
    """Return the folder of the jobs of a command, and of their logs."""
    return build / "jobs" / name


def scripts(command: Sequence[str], site: Site, jobs: int, folder: Path) -> list[str]:
    """Return the scripts for sbatch, one for each array.

    Parameters
    ----------
    command : sequence of str
        Of `landscape`, without --workers and --share.
    site : Site
    jobs : int
        How many jobs share the tasks out.
    folder : Path
        Of their logs.
    """
    most = _most_in_array()
    return [
        _script(command, site, jobs, first, min(most, jobs - first), folder)
        for first in range(0, jobs, most)
    ]


def _script(
    command: Sequence[str], site: Site, jobs: int, before: int, count: int, folder: Path
) -> str:
    """Return the script of the array of so many jobs that comes after those before."""
    at_a_time = f"%{site.at_a_time}" if site.at_a_time else ""
    options = {
        "job-name": f"landscape-{command[0]}",
        "array": f"1-{count}{at_a_time}",
        "partition": site.partition,
        "time": f"{site.minutes}",
        "mem": f"{round(1024 * site.memory_gb)}M",
        "nodes": "1",
        "ntasks": "1",
        "cpus-per-task": f"{site.cores}",
        "open-mode": "append",
        "output": f"{folder.resolve()}/%A_%a.log",
        **site.options,
    }
    program = [str(Path(sys.executable).with_name("landscape")), *command]
    lines = [
        "#!/bin/bash",
        *(f"#SBATCH --{name}={_quoted(value)}" for name, value in options.items()),
        "#SBATCH --requeue",
        "set -e",
        *site.setup,
        f"exec {shlex.join(program)} --workers {site.cores} "
        f"--share $((SLURM_ARRAY_TASK_ID + {before}))/{jobs}",
    ]
    return "\n".join(lines) + "\n"


def _quoted(value: str) -> str:
    """Return the value of an option as sbatch reads it: in double quotes if it has blanks."""
    if not any(one in value for one in " \t\"'\\#"):
        return value
    escaped = value.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


def run(command: Sequence[str], site: Site, missing: Callable[[], int], folder: Path) -> None:
    """Submit jobs until no task is missing, and wait for them with a progress bar.

    Jobs that an earlier call has submitted and that are still there are waited for. As long as some
    task has been done since the last submission, what failed, was preempted or came to its time
    limit is submitted again.

    Parameters
    ----------
    command : sequence of str
        Of `landscape`, without --workers and --share.
    site : Site
    missing : callable
        Returns how many tasks are missing.
    folder : Path
        Of the jobs: their numbers and logs.

    Raises
    ------
    ArgumentError
        If Slurm is not there or refuses the jobs, or they end without having done anything.
    """
    left = missing()
    with tqdm(total=left, desc=command[0], unit=" tasks") as bar:
        while left:
            before, names = left, _submitted(folder)
            are_new = _states(names) == {}
            if are_new:
                names = _submit(scripts(command, site, min(site.jobs, left), folder), folder)
                bar.write(f"submitted to Slurm; `scancel {' '.join(names)}` ends it")
            while (states := _states(names)) != {}:
                looked = time.monotonic()
                bar.set_postfix_str(_said(states), refresh=False)
                bar.update(bar.total - bar.n - missing())
                time.sleep(max(ASKED_EVERY, (time.monotonic() - looked) / LOOKING))
            left = missing()
            bar.update(bar.total - bar.n - left)
            if are_new:
                _require_progress(before, left, folder)
    (folder / JOBS).unlink(missing_ok=True)


def said_of_jobs(folder: Path) -> str:
    """Return how many jobs of a command are in which state; nothing if there are none."""
    states = _states(_submitted(folder))
    return "" if states == {} else _said(states)


def _said(states: Mapping[str, int] | None) -> str:
    if states is None:
        return "Slurm does not answer"
    return ", ".join(f"{count} {state}" for state, count in states.items())


def _require_progress(before: int, left: int, folder: Path) -> None:
    if left < before:
        return
    logs = sorted(folder.glob("*.log"), key=lambda path: path.stat().st_mtime)
    said = logs[-1].read_text("utf-8", "replace").strip().splitlines()[-1:] if logs else []
    raise ArgumentError(
        "executor",
        "make progress",
        f"the jobs have ended and {left} tasks are still missing; see '{folder}'"
        + (f", which says last: {said[0]}" if said else ""),
    )


def _submitted(folder: Path) -> list[str]:
    """Return the numbers of the jobs that were submitted last."""
    path = folder / JOBS
    if not path.exists():
        return []
    must = "hold jobs of Slurm"
    jobs = read_json(path, "build", must).get("jobs", [])
    require(isinstance(jobs, list), "build", must, f"'{path}' holds something else")
    return [str(name) for name in jobs]


def _submit(texts: Sequence[str], folder: Path) -> list[str]:
    """Submit scripts; return the numbers of the jobs, which are kept before the next is.

    Where not even the first can be submitted, no folder stays behind.
    """
    new = [path for path in (folder, *folder.parents) if not path.exists()]
    folder.mkdir(parents=True, exist_ok=True)  # before a job begins to write there
    names: list[str] = []
    try:
        for text in texts:
            names.append(_submit_one(text))
            write_json(folder / JOBS, {"jobs": names})
    finally:
        if not names:
            for path in new:
                path.rmdir()
    return names


def _submit_one(text: str) -> str:
    done = _slurm(["sbatch", "--parsable"], text)
    if done.returncode:
        but = done.stderr.strip().splitlines()[-1:] or ["it says nothing"]
        raise ArgumentError("executor", "be able to submit jobs", f"sbatch refuses: {but[0]}")
    return done.stdout.strip().split(";")[0]


def _states(names: Sequence[str]) -> dict[str, int] | None:
    """Return how many of these jobs wait or run; none if Slurm does not answer just now."""
    if not names:
        return {}
    done = _slurm(["squeue", "--noheader", "--array", "--format=%T", f"--jobs={','.join(names)}"])
    if done.returncode and "Invalid job id" in done.stderr:
        return {}  # it has forgotten them
    if done.returncode:
        return None
    return dict(Counter(state.lower() for state in done.stdout.split()))


def _most_in_array() -> int:
    try:
        said = _slurm(["scontrol", "show", "config"]).stdout
    except ArgumentError:  # scripts can be written where there is no Slurm
        return MOST_IN_ARRAY
    found = [line.split("=")[1] for line in said.splitlines() if line.startswith("MaxArraySize")]
    return int(found[0]) - 1 if found else MOST_IN_ARRAY


def _slurm(command: Sequence[str], text: str | None = None) -> subprocess.CompletedProcess[str]:
    try:
        return subprocess.run(command, input=text, capture_output=True, text=True, check=False)
    except FileNotFoundError:
        but = f"there is no {command[0]} on this machine; --dry-run prints scripts for another"
        raise ArgumentError("executor", "be able to submit jobs", but) from None
