"""Jobs of Slurm: their scripts, and what is said where Slurm is not there, or refuses.

`test_slurm_itself` needs a real Slurm: SLURM_CONF, and daemons that run (`one-node-slurm start`).
"""

from __future__ import annotations

import os
import shutil
import stat
import subprocess
import time

import pytest
from typer.testing import CliRunner

from disorder_landscape import ArgumentError
from disorder_landscape.cli import app
from disorder_landscape.executors import slurm
from disorder_landscape.executors.site import Site, load_site
from disorder_landscape.runs import REPOSITORY

SITE = Site(partition="main", jobs=8, minutes=90, memory_gb=1.5, setup=("module load python",))


@pytest.fixture
def programs(tmp_path, monkeypatch):
    """Return a function that puts a program of Slurm on an otherwise empty PATH."""
    folder = tmp_path / "bin"
    folder.mkdir()
    monkeypatch.setenv("PATH", str(folder))
    monkeypatch.setattr(slurm, "ASKED_EVERY", 0.0)

    def put(name, lines):
        path = folder / name
        path.write_text(f"#!/bin/bash\n{lines}\n")
        path.chmod(path.stat().st_mode | stat.S_IEXEC)

    return put


def test_a_script_runs_the_command_with_a_share(programs, tmp_path):
    (text,) = slurm.scripts(["generate", "--config", "a b.toml"], SITE, 8, tmp_path)
    lines = text.splitlines()
    assert lines[0] == "#!/bin/bash"
    assert "#SBATCH --array=1-8" in lines
    assert "#SBATCH --mem=1536M" in lines
    assert "#SBATCH --time=90" in lines
    assert lines.index("module load python") == len(lines) - 2
    assert lines[-1].endswith(
        "landscape generate --config 'a b.toml' --workers 1 --share $((SLURM_ARRAY_TASK_ID + 0))/8"
    )
    assert subprocess.run(["/bin/bash", "-n"], input=text, text=True, check=False).returncode == 0


def test_values_with_blanks_are_quoted_as_sbatch_reads_them(programs, tmp_path):
    site = SITE.model_copy(update={"options": {"comment": 'two "words" \\'}})
    (text,) = slurm.scripts(["generate"], site, 2, tmp_path / "a b")
    assert f'#SBATCH --output="{tmp_path}/a b/%A_%a.log"\n' in text
    assert '#SBATCH --comment="two \\"words\\" \\\\"\n' in text


def test_arrays_are_split_under_the_limit_of_the_site(programs, tmp_path):
    programs("scontrol", 'echo "MaxArraySize            = 4"')
    site = SITE.model_copy(update={"at_a_time": 2})
    texts = slurm.scripts(["generate"], site, 8, tmp_path)
    arrays = [line for text in texts for line in text.splitlines() if "--array" in line]
    assert arrays == ["#SBATCH --array=1-3%2", "#SBATCH --array=1-3%2", "#SBATCH --array=1-2%2"]
    shares = [text.split("TASK_ID + ")[1].strip() for text in texts]
    assert shares == ["0))/8", "3))/8", "6))/8"]


def test_options_of_a_site_go_first(programs, tmp_path):
    site = SITE.model_copy(update={"options": {"account": "physics", "time": "2-0"}})
    (text,) = slurm.scripts(["generate"], site, 2, tmp_path)
    assert "#SBATCH --account=physics\n" in text
    assert "#SBATCH --time=2-0\n" in text
    assert "--time=90" not in text


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("jobs = 3", "lacks the key partition"),
        ('partition = "main"', "lacks the key jobs"),
        ('partition = "main; rm"\njobs = 3', "it must be the name of a partition"),
        ('partition = "main"\njobs = 0', "jobs is wrong"),
        ('partition = "main"\njobs = 3\nminute = 3', "unknown key minute"),
        ('partition = "main"\njobs = 3\n[options]\n"--qos" = "a"', "must be an option of sbatch"),
    ],
)
def test_a_wrong_site_is_one_sentence(content, said, tmp_path):
    (tmp_path / "site.toml").write_text(content)
    with pytest.raises(ArgumentError, match=said):
        load_site(tmp_path / "site.toml")


def test_where_there_is_no_slurm_it_says_so(programs, tmp_path):
    with pytest.raises(ArgumentError, match="there is no sbatch on this machine; --dry-run"):
        slurm.run(["generate"], SITE, lambda: 3, tmp_path)


def test_a_refusal_of_the_scheduler_is_told(programs, tmp_path):
    programs("scontrol", "")
    programs("sbatch", 'echo "sbatch: error: invalid partition specified: main" >&2; exit 1')
    with pytest.raises(ArgumentError, match=r"sbatch refuses: .* invalid partition specified"):
        slurm.run(["generate"], SITE, lambda: 3, tmp_path)


def test_what_jobs_leave_is_submitted_again_while_they_make_progress(programs, tmp_path):
    """Two tasks are done by each array; then nothing is, which is told with the last log."""
    (tmp_path / "left").write_text("5")
    programs("scontrol", "")
    programs("squeue", 'echo "slurm_load_jobs error: Invalid job id specified" >&2; exit 1')
    programs(
        "sbatch",
        f"cd {tmp_path}; read left < left; if [ $left -gt 1 ]; then left=$((left - 2)); fi\n"
        'echo $left > left; echo . >> submitted; echo "out of memory" > 7_1.log; echo "7;one"',
    )
    with pytest.raises(ArgumentError, match=r"1 tasks are still missing; .* last: out of memory"):
        slurm.run(["generate"], SITE, lambda: int((tmp_path / "left").read_text()), tmp_path)
    assert len((tmp_path / "submitted").read_text().split()) == 3


def test_a_scheduler_that_does_not_answer_is_waited_for(programs, tmp_path):
    programs("scontrol", "")
    programs("sbatch", "echo 7")
    programs(
        "squeue",
        f"cd {tmp_path}; echo . >> asked; case $(/usr/bin/wc -l < asked) in\n"
        '1|2) echo "slurm_load_jobs error: Unable to contact slurm controller" >&2; exit 1;;\n'
        "3) echo RUNNING;; *) exit 0;; esac",
    )
    left = iter([3, 3, 3, 3, 0, 0, 0])
    slurm.run(["generate"], SITE, lambda: next(left), tmp_path)
    assert len((tmp_path / "asked").read_text().split()) == 4
    assert not (tmp_path / slurm.JOBS).exists()


def test_the_command_line_asks_for_what_it_needs(tmp_path):
    config = ["generate", "--config", "configs/smoke.toml", "--build", str(tmp_path)]
    for options, said in (
        (["--executor", "slurm"], "site must be given with --executor slurm"),
        (["--executor", "dask"], "scheduler must be given with --executor dask"),
        (["--share", "0/3"], "share must be like 3/8"),
        (["--dry-run"], "dry-run must be left out without --executor slurm"),
        (["--site", "a.toml", "--executor", "dask"], "site must be left out without --executor"),
        (["--scheduler", "tcp://host:8786"], "scheduler must be left out without --executor dask"),
        (
            ["--workers", "2", "--executor", "slurm"],
            "workers must be left out with --executor slurm",
        ),
        (["--share", "1/1", "--executor", "slurm"], "share must be left out with --executor slurm"),
    ):
        told = CliRunner().invoke(app, [*config, *options])
        assert isinstance(told.exception, ArgumentError)
        assert said in str(told.exception)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--share", "1/2"], "output must be a folder"),
        (["--executor", "slurm"], "output must be a folder"),
        (["--workers", "2"], "workers must be left out for one measurement, which takes all cores"),
    ],
)
def test_one_result_is_not_shared_out(options, said):
    told = CliRunner().invoke(app, ["infer", "one.nc", "-o", "result.nc", *options])
    assert said in str(told.exception)


def test_a_limit_is_refused_where_jobs_would_not_have_it():
    told = CliRunner().invoke(app, ["study", "noise", "--limit", "1", "--executor", "slurm"])
    assert "limit must be left out with --executor slurm" in str(told.exception)


@pytest.mark.parametrize(
    ("command", "program"),
    [
        (["generate", "--config", "configs/smoke.toml"], "generate --config {here}/configs/smoke"),
        (["study", "conventions", "--output"], "study conventions --output {output}"),
    ],
)
def test_a_dry_run_prints_what_a_job_runs(command, program, tmp_path):
    site = tmp_path / "site.toml"
    site.write_text('partition = "main"\njobs = 4\n')
    output = [str(tmp_path)] if command[-1] == "--output" else []
    options = ["--build", str(tmp_path), "--executor", "slurm", "--site", str(site), "--dry-run"]
    told = CliRunner().invoke(app, [*command, *output, *options])
    assert told.exit_code == 0, told.output
    assert program.format(here=REPOSITORY, output=tmp_path) in told.output
    assert told.output.splitlines()[-1].endswith("--share $((SLURM_ARRAY_TASK_ID + 0))/4")
    assert list(tmp_path.iterdir()) == [site]


def test_status_tells_of_jobs(programs, tmp_path):
    programs("squeue", "echo RUNNING; echo PENDING; echo RUNNING")
    jobs = tmp_path / "jobs" / "generate-smoke"
    jobs.mkdir(parents=True)
    (jobs / slurm.JOBS).write_text('{"jobs": ["7"]}')
    command = ["status", "--config", "configs/smoke.toml", "--build", str(tmp_path)]
    assert "jobs        2 running, 1 pending\n" in CliRunner().invoke(app, command).output


CONFIG = """
[dataset]
realizations = 200
sites = 60
mu_points = 8
B_points = 8
shard_size = 5
"""


@pytest.mark.slow
@pytest.mark.skipif(
    shutil.which("sbatch") is None or "SLURM_CONF" not in os.environ, reason="needs a Slurm"
)
def test_slurm_itself(tmp_path):
    """200 wires by eight jobs: one is killed, one requeued, the controller restarted."""
    (tmp_path / "two.toml").write_text(CONFIG)
    (tmp_path / "site.toml").write_text('partition = "main"\njobs = 8\nmemory_gb = 1\n')
    landscape = [shutil.which("landscape"), "generate", "--config", tmp_path / "two.toml"]
    by_jobs = [*landscape, "--build", tmp_path / "jobs", "--executor", "slurm"]
    waits = subprocess.Popen([*by_jobs, "--site", tmp_path / "site.toml"])
    job = None
    while job is None:
        time.sleep(0.5)
        running = slurm_says("squeue", "--noheader", "--array", "--states=R", "--format=%i")
        job = running.split()[0] if running.split() else None
    slurm_says("scancel", "--signal=KILL", "--batch", job)
    other = None
    while other in (None, job):
        time.sleep(0.5)
        running = slurm_says("squeue", "--noheader", "--array", "--states=R", "--format=%i")
        other = running.split()[-1] if running.split() else None
    slurm_says("scontrol", "requeue", other)
    slurm_says("scontrol", "shutdown", "slurmctld")
    time.sleep(3)
    slurm_says("slurmctld")
    start_at_once(other)
    assert waits.wait(600) == 0
    subprocess.run([*landscape, "--build", tmp_path / "local"], check=True)
    here, there = (sorted((tmp_path / of).glob("datasets/*/*.nc")) for of in ("local", "jobs"))
    assert [path.name for path in here] == [path.name for path in there]
    assert [path.read_bytes() for path in here] == [path.read_bytes() for path in there]


def start_at_once(job):
    """Spare the test the two minutes for which Slurm holds a job back that was requeued."""
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline:
        command = ["scontrol", "update", f"JobId={job}", "StartTime=now"]
        if subprocess.run(command, capture_output=True, check=False).returncode == 0:
            return
        time.sleep(1)


def slurm_says(*command):
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout
