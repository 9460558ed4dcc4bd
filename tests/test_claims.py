"""The claims: what the file says, how values are judged, where they come from, what is printed."""

from __future__ import annotations

import hashlib
import inspect
import json
import re
from dataclasses import asdict, dataclass, fields
from pathlib import Path

import numpy as np
import pytest

from disorder_landscape import ArgumentError, Nanowire, conductance
from disorder_landscape.claims import __main__ as command_line
from disorder_landscape.claims import (
    measurements,
    measurements_of_models,
    measurements_of_wires,
    pages,
    table,
)
from disorder_landscape.claims.claim import Claim, ResultMissingError, load_claims
from disorder_landscape.claims.conventions import conventions_table
from disorder_landscape.claims.derived import DERIVED
from disorder_landscape.claims.findings import stored_findings, with_measured
from disorder_landscape.claims.sources import provenance
from disorder_landscape.claims.value import Value, mean_over_seeds
from disorder_landscape.cli import app
from disorder_landscape.config import Config
from disorder_landscape.learning.model import TrainedModel
from disorder_landscape.learning.scaling import LabelScaler
from disorder_landscape.model.disorder import disorder_realization
from disorder_landscape.observables import topological_overlap
from disorder_landscape.runs import CONFIGS, REPOSITORY, presets
from disorder_landscape.studies.rows import as_text, write_rows
from disorder_landscape.studies.study import study_names
from disorder_landscape.studies.trainings_table import Result

ALL = load_claims()
STUDY = {"scale": "small", "file": "results/study.csv", "column": "R2", "where": {"n": 5}}
KEPT = {"id": "x", "statement": "s", "where": "w"}


def claim(**changes):
    """A claim with a study's value to compare 0.95 with."""
    return Claim.model_validate({**KEPT, "paper": 0.95, "ours": [STUDY], **changes})


@pytest.fixture
def study(tmp_path):
    """Write the study's files into an otherwise empty repository."""
    folder = tmp_path / "results"
    folder.mkdir()

    def write(rows="n,R2\n5,0.96\n10,0.9\n", **made):
        (folder / "study.csv").write_text(rows)
        content = {"provenance": {"command": "make study", **made}, "fit": {"R2": 0.97}}
        (folder / "study.json").write_text(json.dumps(content))
        return tmp_path

    return write


# ---- claims.toml and the documents --------------------------------------------------------------


@pytest.mark.parametrize("page", pages.PAGES)
def test_a_document_says_what_the_claims_and_their_results_say(page):
    text = (REPOSITORY / page).read_text("utf-8")
    assert pages.written(page, text) == text, "run `make claims-table`"


def test_only_documents_that_change_are_written(tmp_path):
    for page in pages.PAGES:
        (tmp_path / page).parent.mkdir(exist_ok=True)
        (tmp_path / page).write_text((REPOSITORY / page).read_text("utf-8"), "utf-8")
    damaged = pages.Section("claims").replaced((tmp_path / "docs/claims.md").read_text(), "old")
    (tmp_path / "docs/claims.md").write_text(damaged, "utf-8")
    assert pages.write_pages(tmp_path) == ["docs/claims.md"]
    assert pages.write_pages(tmp_path) == []


def test_every_verdict_that_is_not_reproduced_has_a_reason():
    for found in stored_findings(ALL):
        assert found.reason or found.verdict == "reproduced", found.claim.id


def test_every_quick_measurement_exists_and_takes_its_arguments():
    for one in ALL:
        if one.measured is not None:
            function = measurements.MEASUREMENTS[one.measured.measure]
            inspect.signature(function).bind(**one.measured.arguments)


def test_every_claim_named_by_another_exists():
    ids = {one.id for one in ALL}
    for one in ALL:
        named = re.findall(r"(?:as for|as in|than|:) ([a-z0-9]+(?:-[a-z0-9.]+)+)", one.remark)
        named += re.findall(r"(?:as for|it:|as in) ([a-z0-9]+(?:-[a-z0-9.]+)+)", one.reason)
        assert set(named) <= ids, (one.id, named)


def test_every_command_of_a_value_that_is_there_exists():
    for found in stored_findings(ALL):
        if found.deciding is not None:
            program, *words = found.command.split()
            assert EXISTS[program](words), found.command


def make_exists(words):
    makefile = (REPOSITORY / "Makefile").read_text("utf-8")
    targets = set(re.findall(r"^([a-z-]+):", makefile, re.MULTILINE))
    scripts = (REPOSITORY / "paper_figures").glob("figure_*.py")
    targets |= {"figure-" + script.stem.split("_")[1] for script in scripts}
    given = dict(word.split("=") for word in words[1:])
    drawn = set(presets())
    configs = {path.stem for path in CONFIGS.glob("*.toml")}
    allowed = {
        "PRESET": drawn if words[0].startswith("figure") else configs,
        "STUDY": set(study_names()),
        "ONLY": {one.id for one in ALL},
        "STORE": {"1"},
    }
    return words[0] in targets and all(value in allowed[name] for name, value in given.items())


def _tests_exist(words):
    chosen = words[words.index("-k") + 1]
    pattern = re.compile(rf"^def test_\w*{chosen}", re.MULTILINE)
    tests = Path(__file__).parent.rglob("test_*.py")
    return any(pattern.search(path.read_text("utf-8")) for path in tests)


def _command_exists(words):
    commands = {command.callback.__name__ for command in app.registered_commands}
    return words[0] in commands and (words[0] != "study" or words[1] in study_names())


EXISTS = {
    "make": make_exists,
    "pytest": _tests_exist,
    "landscape": _command_exists,
}
"""How each program that a command may name is checked."""


@pytest.mark.parametrize(
    ("command", "exists"),
    [
        ("make evaluate PRESET=small", True),
        ("make figure-S9", True),
        ("make nonesuch", False),
        ("make evaluate PRESET=nonesuch", False),
        ("make claims ONLY=nonesuch", False),
        ("landscape study accuracy", True),
        ("landscape study nonesuch", False),
        ("landscape train", True),
        ("landscape nonesuch", False),
        ("pytest -k components_required", True),
        ("pytest -k nonesuch", False),
    ],
)
def test_commands_that_do_not_exist_are_noticed(command, exists):
    program, *words = command.split()
    assert EXISTS[program](words) == exists


# ---- one claim ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("sense", "tolerance", "reproduced", "differing"),
    [
        ("at least", 0.005, (0.945, 0.95, 1.0), (0.9449, -1e10)),
        ("at most", 0.005, (0.955, 0.95, -3.0), (0.9551, np.inf)),
        ("within", 0.005, (0.945, 0.955), (0.9449, 0.9551)),
        ("exactly", 0, (0.95,), (0.9500001, 0.9499999)),
    ],
)
def test_each_sense_of_a_tolerance(sense, tolerance, reproduced, differing):
    one = claim(sense=sense, tolerance=tolerance)
    assert {one.judge(Value(value)) for value in reproduced} == {"reproduced"}
    assert {one.judge(Value(value)) for value in differing} == {"differs"}
    assert one.judge(Value(np.nan)) == "differs"


@pytest.mark.parametrize(
    ("sense", "interval", "verdict"),
    [
        ("at least", (0.93, 0.951), "undecided"),
        ("at least", (0.92, 0.944), "differs"),
        ("within", (0.93, 0.951), "undecided"),
        ("within", (0.93, 0.94), "differs"),
        ("at most", (0.93, 0.96), "reproduced"),
    ],
)
def test_an_interval_that_reaches_what_is_accepted_decides_nothing(sense, interval, verdict):
    one = claim(sense=sense, tolerance=0.0 if sense != "within" else 0.005)
    assert one.judge(Value(0.94, interval)) == verdict


def test_seeds_make_an_interval():
    found = mean_over_seeds([1.0, 2.0, 3.0])
    assert found.value == 2.0
    assert found.interval == pytest.approx((2 - 4.303 / np.sqrt(3), 2 + 4.303 / np.sqrt(3)), 1e-3)
    assert mean_over_seeds([1.0, 2.0]).interval is None
    assert found.scaled(2.0).interval == pytest.approx(2 * np.array(found.interval))
    assert found.from_one().interval == pytest.approx(1 - np.array(found.interval)[::-1])


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"sense": "about"}, "sense"),
        ({"tolerance": -1}, "tolerance"),
        ({"verdict": "reproduced"}, "verdict"),
        ({"paper": None}, "number to compare"),
        ({"sense": "exactly", "tolerance": 0.1}, "tolerance"),
        ({"ours": []}, "reason"),
        ({"command": "make help"}, "minutes"),
        ({"ours": [{"scale": "s", "file": "f"}]}, "key"),
        ({"ours": [{"scale": "s", "measure": "m"}] * 2}, "one quick measurement"),
        ({"id": "Not An Id"}, "id"),
    ],
)
def test_a_wrong_claim_is_one_sentence(wrong, said, tmp_path):
    content = {**KEPT, "paper": 0.95, "ours": [STUDY], **wrong}
    file = tmp_path / "claims.toml"
    file.write_text("[[claim]]\n" + "".join(_toml(k, v) for k, v in content.items()))
    with pytest.raises(ArgumentError, match=f"^Argument claims must .*{said}"):
        load_claims(file)


def _toml(key, value):
    if value is None:
        return ""
    if key == "ours":
        inline = (", ".join(_toml(k, v).strip() for k, v in one.items()) for one in value)
        return f"ours = [{', '.join('{' + one + '}' for one in inline)}]\n"
    if isinstance(value, dict):
        return f"{key} = {{{', '.join(_toml(k, v).strip() for k, v in value.items())}}}\n"
    return f"{key} = {json.dumps(value)}\n"


def test_two_claims_of_one_id_are_refused(tmp_path):
    file = tmp_path / "claims.toml"
    file.write_text(
        2 * '[[claim]]\nid = "x"\nstatement = "s"\nwhere = "w"\nwhy = "w"\nreason = "r"\n'
    )
    with pytest.raises(ArgumentError, match="x is there twice"):
        load_claims(file)


# ---- values and where they come from ------------------------------------------------------------


def test_a_claim_turns_on_when_its_study_has_run(study, tmp_path):
    (before,) = stored_findings([claim(sense="at least")], tmp_path)
    assert (before.verdict, before.deciding) == ("not tested", None)
    assert before.reason == "there is no results/study.csv"
    (after,) = stored_findings([claim(sense="at least")], study())
    assert (after.verdict, after.deciding.value) == ("reproduced", 0.96)
    assert after.reason == ""


def test_the_first_value_that_is_there_decides_and_each_has_its_verdict(study):
    absent = {"scale": "full", "file": "results/absent.json", "key": "R2"}
    ten = {**STUDY, "scale": "ten", "where": {"n": 10}}
    (found,) = stored_findings([claim(sense="at least", ours=[absent, STUDY, ten])], study())
    assert [one.verdict for one in found.outcomes] == ["not tested", "reproduced", "differs"]
    assert found.verdict == "reproduced"
    assert table.ours(found) == "0.96 ✓ (small); 0.9 ✗ (ten)"


@pytest.mark.parametrize(
    ("source", "value"),
    [
        ({"where": {}, "reduce": "mean"}, 0.93),
        ({"where": {}, "reduce": "min"}, 0.9),
        ({"where": {"n": "10"}, "times": 2}, 1.8),
        ({"where": {"n": "10"}, "times": 0.5, "from_one": True}, 0.55),
        ({"minus": {"n": 10}}, 0.06),
        ({"where": {}, "column": None, "file": "results/study.json", "key": "fit/R2"}, 0.97),
    ],
)
def test_values_of_csv_and_json(source, value, study):
    (found,) = stored_findings([claim(ours=[{**STUDY, **source}])], study())
    assert found.deciding.value == pytest.approx(value)


def test_what_a_study_took_is_what_it_says(study):
    (found,) = stored_findings([claim()], study(minutes=12.4))
    assert (found.command, found.minutes) == ("make study", 12.4)
    assert table.measured_by(found) == "`make study`, 12 min"
    (found,) = stored_findings([claim(command="make help", minutes=1)], study())
    assert table.measured_by(found) == "`make help`, 1.0 min"


@pytest.mark.parametrize(
    ("source", "said"),
    [
        ({"where": {}}, "one row .* it has 2"),
        ({"derive": "nonesuch", "column": None}, "derive must name one of"),
        ({"column": "R3"}, "column R3"),
        ({"column": "word", "where": {"n": 5}}, "a number as word"),
        ({"where": {}, "column": None, "file": "results/study.json", "key": "fit/p"}, "fit/p"),
    ],
)
def test_a_study_without_the_value_is_an_error(source, said, study):
    root = study("n,R2,word\n5,0.96,good\n10,0.9,bad\n")
    with pytest.raises(ArgumentError, match=said):
        stored_findings([claim(ours=[{**STUDY, **source}])], root)


def test_a_study_that_has_not_come_so_far_is_waited_for(study):
    (found,) = stored_findings([claim(ours=[{**STUDY, "where": {"n": 7}}])], study())
    assert found.verdict == "not tested"
    said = "not tested yet: results/study.csv has no row with n = 7"
    assert table.verdict(found).startswith(said)


def test_a_study_without_provenance_has_its_plan(study):
    root = study("n,R2,minutes\n5,0.96,2.5\n10,0.9,4\n")
    (root / "results" / "study.json").unlink()
    plan = root / "configs" / "studies" / "study.toml"
    plan.parent.mkdir(parents=True)
    plan.write_text("")
    (found,) = stored_findings([claim()], root)
    assert (found.command, found.minutes) == ("landscape study study", 6.5)


def test_a_result_must_tell_how_it_was_made(study):
    root = study()
    (root / "results" / "study.json").write_text("{}")
    with pytest.raises(ArgumentError, match="the command that made it"):
        stored_findings([claim()], root)


def test_a_result_must_have_its_checksum(study):
    rows = "n,R2\n5,0.96\n"
    root = study(rows, sha256=hashlib.sha256(rows.encode()).hexdigest(), minutes=3)
    assert provenance(claim(), claim().ours[0], root) == {
        "command": "make study",
        "minutes": 3,
        "sha256": hashlib.sha256(rows.encode()).hexdigest(),
    }
    (root / "results" / "study.csv").write_text("n,R2\n5,0.99\n")
    with pytest.raises(ArgumentError, match="another file"):
        stored_findings([claim()], root)


def test_shipped_data_must_have_the_checksum_that_is_shipped_with_them(tmp_path):
    model = tmp_path / "data_small" / "models" / "m"
    model.mkdir(parents=True)
    (model / "metrics.json").write_text('{"r2": 0.97}')
    (model / "config.json").write_text('{"command": "landscape train"}')
    digest = hashlib.sha256(b'{"r2": 0.97}').hexdigest()
    sums = tmp_path / "data_small" / "SHA256SUMS"
    sums.write_text(f"{digest}  models/m/metrics.json\n")
    source = {"scale": "s", "file": "data_small/models/m/metrics.json", "key": "r2"}
    (found,) = stored_findings([claim(ours=[source], sense="at least")], tmp_path)
    assert found.verdict == "reproduced"
    sums.write_text(f"{'0' * 64}  models/m/metrics.json\n")
    with pytest.raises(ArgumentError, match="another file"):
        stored_findings([claim(ours=[source])], tmp_path)


# ---- what is derived from a study's table -------------------------------------------------------


def write_table(path, results):
    write_rows(path, [as_text(asdict(result)) for result in results], "test")


def trainings(rows):
    """Results of (components, realizations, width_fraction, seed, R2)."""
    names = ("components", "realizations", "width_fraction", "seed", "R2")
    rest = {
        field.name: "" if field.type == "str" else 0
        for field in fields(Result)
        if field.name not in names
    }
    return [Result(**dict(zip(names, row, strict=True)), **rest) for row in rows]


@pytest.fixture
def learning_curves_table(tmp_path):
    """Curves, straight in the logarithm, that cross R² = 0.77 at 2·n³, above it for n = 10."""
    rows = [
        (n, size, 0.1, seed, 0.77 + 0.1 * np.log(size / (off * 2 * n**3)))
        for n, off in ((3, 1), (5, 1), (8, 1), (10, 1.5))
        for seed in (0, 1)
        for size in (n**3, 4 * n**3)
    ]
    write_table(tmp_path / "learning_curves.csv", trainings(rows))
    return tmp_path / "learning_curves.csv"


def test_the_fit_of_figure_2_is_derived_from_the_learning_curves(learning_curves_table):
    found = {name: function(learning_curves_table) for name, function in list(DERIVED.items())[:6]}
    of = {name: value.value for name, value in found.items()}
    low, high = found["fig2_exponent"].interval
    assert low == pytest.approx(high)  # the seeds are alike
    assert of["fig2_exponent"] == pytest.approx(low)
    assert of["fig2_fit"] < 0.9999 < of["fig2_fit_without_ten"]
    assert of["fig2_exponent"] > 3
    assert of["fig2_prefactor"] < 2
    assert 0 < of["fig2_power_minus_exponential"] < 0.02
    assert of["gain_of_last_step"] == pytest.approx(0.1 * np.log(4))


def test_half_of_the_filters_is_derived_from_the_widths(tmp_path):
    rows = [
        (n, 100, width, seed, 0.77 - loss * (width == 0.5) + 0.01 * seed)
        for n, loss in ((3, 0.002), (4, 0.001), (5, 0.006), (7, 0.003), (8, 0.004))
        for width in (0.5, 1.0)
        for seed in (0, 1, 2)
    ]
    write_table(tmp_path / "network_width.csv", trainings([*rows, (10, 100, 1.0, 0, 0.7)]))
    loss = DERIVED["loss_of_halving"](tmp_path / "network_width.csv")
    assert loss.value == pytest.approx(0.006)
    assert loss.interval == pytest.approx((0.006, 0.006))  # seeds move both widths alike
    p = DERIVED["halving_independent_of_components"](tmp_path / "network_width.csv")
    assert p.value == pytest.approx(42 / 120)  # orders of five whose |ρ| is at least 0.6
    write_table(tmp_path / "two_seeds.csv", trainings([row for row in rows if row[3] < 2]))
    assert DERIVED["loss_of_halving"](tmp_path / "two_seeds.csv").interval is None


@pytest.mark.parametrize("name", DERIVED)
def test_what_is_derived_waits_for_its_study(name, tmp_path):
    write_table(tmp_path / "study.csv", trainings([(5, 100, 1.0, 0, 0.9)]))
    with pytest.raises(ResultMissingError, match=r"study\.csv "):
        DERIVED[name](tmp_path / "study.csv")


# ---- measuring again ----------------------------------------------------------------------------


def quick(**changes):
    source = {"scale": "s", "measure": "components_required", "spread": 0.01, **changes}
    return claim(ours=[source])


def stored_as(value, root):
    (root / "results").mkdir(exist_ok=True)
    content = {"x": {"value": value, "minutes": 0.5, "command": "make claims ONLY=x STORE=1"}}
    (root / "results" / "measured.json").write_text(json.dumps(content))
    return root


@pytest.mark.parametrize(
    ("stored", "again", "agrees"),
    [(0.95, 0.959, True), (0.95, 0.961, False), (200, 201.9, True), (200, 203, False)],
)
def test_a_measurement_must_agree_with_the_stored_one(stored, again, agrees, tmp_path):
    found = stored_findings([quick()], stored_as(stored, tmp_path))
    (found,) = with_measured(found, {"x": again})
    assert (found.disagreement == "") == agrees
    assert found.deciding.value == stored  # what was measured again decides nothing


def test_a_measurement_that_needs_a_study_waits_for_it(tmp_path):
    waiting = quick(needs="data_small/models/ten_components")
    (found,) = stored_findings([waiting], stored_as(0.95, tmp_path))
    assert found.reason == "there is no data_small/models/ten_components"
    (tmp_path / waiting.measured.needs).mkdir(parents=True)
    (found,) = stored_findings([waiting], tmp_path)
    assert found.verdict == "reproduced"


@pytest.fixture
def claims_command(monkeypatch, tmp_path, capsys):
    """Run the command line where every measurement gives the same value at once."""

    def run(*options, value=54.0):
        monkeypatch.setattr(measurements, "measure", lambda source: value)
        code = 0
        try:
            command_line.main([*options, "--output", str(tmp_path / "out")])
        except SystemExit as stop:
            code = stop.code
        return code, capsys.readouterr()

    return run


def test_the_command_prints_and_writes_one_claim(claims_command, tmp_path):
    code, said = claims_command("--only", "components-54")
    assert code == 0
    assert "components-54" in said.out
    assert "1 claims: 1 reproduced" in said.out
    written = json.loads((tmp_path / "out" / "claims.json").read_text("utf-8"))
    (one,) = written["claims"]
    assert (one["id"], one["paper"], one["measured_again"]) == ("components-54", 54, 54)
    assert (tmp_path / "out" / "claims.md").read_text("utf-8").count("components-54") == 2


def test_a_disagreement_is_said_and_fails(claims_command):
    code, said = claims_command("--only", "components-54", value=39.0)
    assert code == 1
    assert "components-54: measured again it is 39, stored is 54" in said.err


@pytest.mark.parametrize("options", [("--only", "nonesuch"), ("--stored", "--only", "R2")])
def test_bad_input_is_one_sentence_and_writes_nothing(options, claims_command, tmp_path):
    code, said = claims_command(*options)
    assert code == 2
    assert said.err.startswith("claims: Argument only must be one of ")
    assert said.err.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_help_has_a_worked_example(capsys):
    with pytest.raises(SystemExit):
        command_line.main(["--help"])
    assert "example: python -m disorder_landscape.claims --only" in capsys.readouterr().out


# ---- the marks and the print of numbers ---------------------------------------------------------


def test_a_section_is_replaced_and_nothing_else():
    section = pages.Section("claims")
    before = f"a\n{section.begin}\nold\n{section.end}\nz\n"
    new = section.replaced(before, "new")
    assert new == f"a\n{section.begin}\n\nnew\n{section.end}\nz\n"
    assert section.replaced(new, "new") == new
    for damaged in ("a\n", before + before, f"{section.end}{section.begin}"):
        with pytest.raises(ArgumentError, match="the two marks of the claims"):
            section.replaced(damaged, "new")


def test_conventions_are_compared_with_the_mean_of_the_references(tmp_path):
    common = {field.name: "x" if field.type == "str" else 0 for field in fields(Result)}
    common |= {"delta_V": 0.3, "delta_alpha": 0.6}
    values = [("reference", 0, 0.98), ("reference", 1, 0.96), ("raw", 0, 0.91)]
    results = [
        Result(
            **{**common, "name": name, "seed": seed, "R2": R2, "delta_V": 0.3, "delta_alpha": 0.6}
        )
        for name, seed, R2 in values
    ]
    path = tmp_path / "conventions.csv"
    write_table(path, results)
    _, _, paper, reference, raw = conventions_table(path).splitlines()
    assert paper.startswith("| the paper, 8,000 wires | 0.991 |  | 0.0350 | 0.37 | 0.110 | 1.16 |")
    assert reference == "| reference | 0.9700 ± 0.0100 |  | 0.3000 | 1.73 | 0.600 | 3.46 |"
    assert raw == "| raw | 0.9100 | −0.060 | 0.3000 | 1.00 | 0.600 | 2.00 |"
    write_table(path, results[2:])
    with pytest.raises(ArgumentError, match="have a run named reference"):
        conventions_table(path)


@pytest.mark.parametrize(
    ("value", "printed"),
    [
        (54.0, "54"),
        (8000, "8,000"),
        (1.2e6, "1,200,000"),
        (66666.7, "66,667"),
        (0.0350, "0.035"),
        (0.994233, "0.99423"),
        (0.99995, "0.99995"),
        (0.9999999, "1"),
        (-0.00156, "−0.00156"),
        (-8.66e9, "−8.7·10⁹"),
        (1.3e-5, "1.3·10⁻⁵"),
    ],
)
def test_numbers_are_printed_short(value, printed):
    assert table.number(value) == printed


def test_each_claim_of_the_short_table_is_a_link_to_its_section():
    found = stored_findings(ALL)
    for one, cells in zip(found, table.summary(found), strict=True):
        link = re.fullmatch(r"\[(.*)\]\(#(.*)\)", cells[0])
        text = table.section(one)
        assert text.startswith(f"## {link[1]}\n")
        assert link[2] == re.sub(r"[^\w-]", "", link[1])  # as MyST and web hosts name a heading
        assert cells[1] in text
        assert cells[2] in text
        assert bool(cells[4]) == (cells[3] != "reproduced")
        assert one.claim.statement in text


def test_markdown_escapes_what_would_end_a_cell():
    assert table.markdown(("a", "b"), [("x|y", "")]) == "| a | b |\n|---|---|\n| x\\|y |  |\n"


# ---- the measurements ---------------------------------------------------------------------------


def test_arithmetic_of_the_papers_core_hours():
    sets = {"sets": 400, "seconds": "set-seconds"}
    hours = measurements.core_hours_of_dataset(realizations="realizations-ten", **sets)
    assert hours == pytest.approx(50_000 * 400 * 12 / 3600)
    fit = {"prefactor": "fig2-prefactor", "exponent": "fig2-exponent"}
    for components in (30, 50):
        needed = 0.0672 * components**4.9232
        hours = measurements.core_hours_of_components(components, **sets, **fit)
        assert hours == pytest.approx(needed * 400 * 12 / 3600)


def test_the_transition_of_a_long_pristine_wire_is_where_theory_says():
    assert measurements_of_wires.transition(0.3) == pytest.approx(1, abs=0.02)


def test_the_mean_is_told_by_no_component(monkeypatch):
    monkeypatch.setattr(measurements_of_wires, "DRAWS", 1000)
    measurements_of_wires._realizations.cache_clear()
    assert abs(measurements_of_wires.r2_of_mean_from_components(5)) < 0.05
    assert measurements_of_wires.mean_spread(5) == pytest.approx(0.01, rel=0.1)
    measurements_of_wires._realizations.cache_clear()


@dataclass
class Oracle:
    """A network that knows the standard-scaled labels, and is wrong in c₁ by so much."""

    y: np.ndarray
    wrong: float = 0.0

    def predict_on_batch(self, x):
        self.x = x
        return self.y + self.wrong * np.eye(self.y.shape[1])[0]


@pytest.fixture
def oracle(monkeypatch):
    """Four short wires, their conductances, and a network that knows them."""
    grid = {"sites": 60, "mu_points": 2, "B_points": 3}
    config = Config.model_validate({"dataset": {"realizations": 4, **grid}})
    drawn = [disorder_realization(np.random.default_rng(i), 5, 60) for i in range(4)]
    alpha = np.array([7.0, 7.5, 8.0, 8.5])
    wires = [Nanowire(V, alpha=a) for (_, V), a in zip(drawn, alpha, strict=True)]
    dataset = config.dataset
    G = conductance(wires, dataset.mu, dataset.B, dataset.bias, dataset.temperature)
    test = G.assign(
        components=(("realization", "component"), np.array([c for c, _ in drawn])),
        potential=(("realization", "site"), np.array([V for _, V in drawn])),
        alpha=("realization", alpha),
    )
    Y = np.column_stack([test["components"], alpha])
    names = (*(f"c_{n}" for n in range(1, 6)), "alpha")
    scaler = LabelScaler(names, Y.mean(axis=0), Y.std(axis=0))
    network = Oracle(scaler.scale(Y))
    trained = TrainedModel(network, scaler, None, config)
    monkeypatch.setattr(measurements_of_models, "_loaded", lambda model: (test, trained))
    monkeypatch.setattr(topological_overlap, "POINTS", (5, 9))
    return network


def test_a_network_that_knows_scores_one(oracle):
    for score, best in {"r2": 1.0, "delta_V": 0.0, "delta_alpha": 0.0}.items():
        ours = measurements_of_models.model_score("knows", score)
        assert ours == pytest.approx(best, abs=1e-9)
    for channels in ("local", "nonlocal"):
        match = measurements_of_models.conductance_match("knows", channels, "known")
        assert match == pytest.approx(1, abs=1e-6)
        assert measurements_of_models.conductance_match("knows", channels, "predicted") < match
    assert measurements_of_models.visibility_match("knows", "known") == 1
    with pytest.raises(ArgumentError, match="mean must"):
        measurements_of_models.visibility_match("knows", "wrong")


def test_a_network_that_errs_scores_less(oracle):
    oracle.wrong = 0.5
    assert measurements_of_models.model_score("errs", "r2") < 1
    assert measurements_of_models.conductance_match("errs", "local", "known") < 1


def test_noise_is_added_to_the_channels_that_are_asked_for(oracle):
    measurements_of_models.model_score("noise", "r2")
    quiet = oracle.x
    measurements_of_models.model_score("noise", "r2", noise=0.05, channels="nonlocal")
    error = oracle.x - quiet
    assert (error[..., :2] == 0).all()
    assert error[..., 2:].std() == pytest.approx(0.05, rel=0.2)
    assert measurements_of_models.loss_by_noise("noise", 0.05) == 0
