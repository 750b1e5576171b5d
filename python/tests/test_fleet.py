"""Rows of a fleet: by the command line, from paths, bytes and URIs, and on Ray, the same to the byte; and what they say together."""

import json
import os
import signal
import subprocess
import sys
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow
import pyarrow.parquet
import pytest
from conftest import run

import socam
import socam.fleet

MODEL = "two-mass"


@dataclass
class Fleet:
    """Recordings, and what the command line says of them."""

    recordings: Path
    healthy: Path
    table: Path
    page: Path
    summary: dict[str, Any]
    #: What the healthy recording shows: the option `frozen`.
    reference: dict[str, Any]

    def rows(self) -> pyarrow.Table:
        return pyarrow.parquet.read_table(self.table)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A small fleet: sound and rubbing machines, one with a hump that no effect explains, a file that is none, an empty one, one of another bench."""
    folder = tmp_path_factory.mktemp("fleet")
    # A friction of 0.3 N m holds the bench: such a recording stands out, and lacks nothing that moves a prediction.
    friction = {3: 0.1, 4: 0.3}
    for number in range(6):
        hide = [f"coulomb_friction@load_bearing:torque={friction[number]}"] if number in friction else []
        made = socam.simulate(MODEL, "prbs", duration_s=3.0, rate_hz=200.0, seed=number + 1, hide=hide)
        machine = folder / f"SN{number % 3}"
        machine.mkdir(exist_ok=True)
        made.write(machine / f"2026-01-0{number + 1}.csv")
    columns = dict(socam.simulate(MODEL, "prbs", duration_s=3.0, rate_hz=200.0, seed=9))
    columns["load_speed_rad_s"] = columns["load_speed_rad_s"] + 2.0 * np.exp(-(((columns["t_s"] - 1.5) / 0.1) ** 2))
    socam.read(columns).write(folder / "SN2" / "2026-01-09.csv")
    (folder / "SN0" / "noise.csv").write_bytes(bytes(range(256)))
    (folder / "SN1" / "empty.mcap").write_bytes(b"")
    (folder / "other.csv").write_text("t_s,position_m\n0,1\n0.1,2\n0.2,1\n")
    return folder


@pytest.fixture(scope="module")
def fleet(folder: Path, host: Path, tmp_path_factory: pytest.TempPathFactory) -> Fleet:
    """The fleet by the command line."""
    if "fleet" not in run(host, "--help"):
        pytest.skip("this socam-host has no command fleet")
    out = tmp_path_factory.mktemp("out")
    healthy, table, page, reference = folder / "SN0" / "2026-01-01.csv", out / "fleet.parquet", out / "fleet.html", out / "reference.toml"
    command = ["fleet", str(folder), "--model", MODEL, "-o", str(table), "--jobs", "2", "--reference", str(healthy)]
    summary = json.loads(run(host, *command, "--write-reference", str(reference), "--report", str(page), "--json"))
    return Fleet(folder, healthy, table, page, summary, tomllib.loads(reference.read_text()))


def test_a_row_whatever_goes_wrong(folder: Path) -> None:
    path = folder / "SN1" / "2026-01-02.csv"
    row = socam.fleet.diagnose_one(path, MODEL)
    assert (row.status, row.document["recording"]) == ("ok", "2026-01-02.csv")
    assert row.to_arrow().num_rows == 1 and len(row.id) == 64
    for bad in [b"", b"\xff\x00", folder / "absent.csv", "file:///absent.csv", folder, folder.as_uri()]:
        row = socam.fleet.diagnose_one(bad, MODEL)
        assert row.status == "unreadable" and row.message and row.verdict is None
    with pytest.raises(ValueError, match="none with the name"):
        socam.fleet.diagnose_one(path, MODEL, magic=1)
    with pytest.raises(ValueError, match="not in its text"):
        socam.fleet.diagnose_one(path, socam.Model(MODEL).fix(["stiffness"]))


def test_rows_are_those_of_the_command_line(fleet: Fleet) -> None:
    """One by one, from a path, its bytes and its URI: Arrow rows that equal those of the table."""
    table = fleet.rows()
    kinds = set(zip(table["status"].to_pylist(), table["verdict"].to_pylist()))
    assert kinds == {("ok", "adequate"), ("ok", "missing_physics"), ("ok", "unexplained"), ("unreadable", None), ("unfit", None)}
    rows = []
    for number, name in enumerate(table["recording"].to_pylist()):
        path = fleet.recordings / name
        source: Any = (path, path.read_bytes(), path.as_uri())[number % 3]
        rows.append(socam.fleet.diagnose_one(source, MODEL, name=name, frozen=fleet.reference).to_arrow())
    assert pyarrow.concat_tables(rows).equals(table)


def test_a_row_with_a_diagnosis_says_what_diagnose_says(fleet: Fleet) -> None:
    """The cascade's last stage is `diagnose` of the one recording; what it freezes decides only whether a recording gets there."""
    for row in fleet.rows().to_pylist():
        if row["stage"] != "diagnosis":
            continue
        found = socam.diagnose(fleet.recordings / row["recording"], MODEL)
        assert row["verdict"] == found.verdict
        assert [(one["effect"], one["place"]) for one in row["findings"]] == [(one.effect, one.location) for one in found.findings]
        for ours, theirs in zip(row["findings"], found.findings, strict=True):
            assert ours["sentence"] == theirs.sentence
            if ours["parameter"]:
                [size] = [one for one in theirs.parameters if one.name == ours["parameter"]]
                assert (ours["size"], ours["low"], ours["high"], ours["unit"]) == (size.value, size.low, size.high, size.unit)
        fits = found.document["fit"]["channels"]
        assert {one["name"]: one["rms_corrected"] for one in row["channels"]} == {name: fit["rms_after"] for name, fit in fits.items()}


def test_the_summary_is_that_of_the_command_line(fleet: Fleet, tmp_path: Path) -> None:
    summary = socam.fleet.summary(fleet.table)
    assert summary.document == fleet.summary
    assert summary.counts["recordings"] == 10 and [one["machine"] for one in summary.faulty]
    summary.report(tmp_path / "page.html")
    ours, theirs = ((place.read_text().partition("About this page")[0]) for place in (tmp_path / "page.html", fleet.page))
    assert ours == theirs and summary.faulty[0]["machine"] in summary._repr_html_()
    with pytest.raises(socam.SocamError, match="no table of a fleet"):
        socam.fleet.summary(fleet.healthy)
    with pytest.raises(ValueError, match="between 0 and 1"):
        socam.fleet.summary(fleet.table, fdr=0.0)


def test_ray_writes_the_table_of_the_command_line(fleet: Fleet, tmp_path: Path) -> None:
    pytest.importorskip("ray", reason="Ray is not installed: pip install 'ray[data]'")
    program = Path(__file__).parents[1] / "benchmarks" / "fleet.py"
    spread, killed = tmp_path / "ray.parquet", tmp_path / "killed.parquet"
    command = [sys.executable, str(program), "run", str(fleet.recordings), str(spread), "--model", MODEL, "--workers", "2"]
    command += ["--reference", str(fleet.healthy)]
    subprocess.run(command, check=True)
    assert spread.read_bytes() == fleet.table.read_bytes()
    # A worker is killed after the second row, and the driver after the fourth; the driver is then started again.
    command[4] = str(killed)
    ended = subprocess.run([*command, "--kill-worker", "2", "--kill-driver", "4"], check=False)
    assert ended.returncode == -signal.SIGKILL and not killed.exists()
    assert os.path.getsize(f"{killed}.part") > 0
    subprocess.run(command, check=True)
    assert killed.read_bytes() == fleet.table.read_bytes()
