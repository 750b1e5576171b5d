"""Rows of a fleet: from paths, bytes and URIs, here and on Ray, the same to the byte."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pyarrow.parquet
import pytest
from conftest import run

import socam
import socam.fleet

MODEL = "two-mass"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A small fleet: sound and rubbing machines, a file that is none, and an empty one."""
    folder = tmp_path_factory.mktemp("fleet")
    for number in range(6):
        hide = ["coulomb_friction@load_bearing:torque=0.3"] if number == 3 else []
        made = socam.simulate(MODEL, "prbs", duration_s=3.0, rate_hz=200.0, seed=number + 1, hide=hide)
        machine = folder / f"SN{number % 3}"
        machine.mkdir(exist_ok=True)
        made.write(machine / f"2026-01-0{number + 1}.csv")
    (folder / "SN0" / "noise.csv").write_bytes(bytes(range(256)))
    (folder / "SN1" / "empty.mcap").write_bytes(b"")
    return folder


def test_a_row_whatever_goes_wrong(folder: Path) -> None:
    path = folder / "SN1" / "2026-01-02.csv"
    row = socam.fleet.diagnose_one(path, MODEL)
    assert (row.status, row.document["recording"]) == ("ok", "2026-01-02.csv")
    for other in [path.read_bytes(), path.as_uri()]:
        assert socam.fleet.diagnose_one(other, MODEL, name=path.name).document == row.document
    assert row.to_arrow().num_rows == 1 and len(row.id) == 64
    for bad in [b"", b"\xff\x00", folder / "absent.csv", "file:///absent.csv", folder]:
        row = socam.fleet.diagnose_one(bad, MODEL)
        assert row.status == "unreadable" and row.message and row.verdict is None
    with pytest.raises(ValueError, match="none with the name"):
        socam.fleet.diagnose_one(path, MODEL, magic=1)
    with pytest.raises(ValueError, match="not in its text"):
        socam.fleet.diagnose_one(path, socam.Model(MODEL).fix(["stiffness"]))


def test_ray_writes_the_table_of_the_command_line(folder: Path, host: Path, tmp_path: Path) -> None:
    pytest.importorskip("ray", reason="Ray is not installed")
    if "fleet" not in run(host, "--help"):
        pytest.skip("this socam-host has no command fleet")
    plain = tmp_path / "plain.parquet"
    run(host, "fleet", str(folder), "--model", MODEL, "-o", str(plain), "--jobs", "1")
    program = Path(__file__).parents[1] / "benchmarks" / "fleet.py"
    spread, killed = tmp_path / "ray.parquet", tmp_path / "killed.parquet"
    command = [sys.executable, str(program), "run", str(folder), str(spread), "--model", MODEL, "--workers", "2"]
    subprocess.run(command, check=True)
    assert spread.read_bytes() == plain.read_bytes()
    assert pyarrow.parquet.read_table(spread).num_rows == 8
    # A worker is killed after the second row, and the driver after the fourth; the driver is then started again.
    command[4] = str(killed)
    ended = subprocess.run([*command, "--kill-worker", "2", "--kill-driver", "4"], check=False)
    assert ended.returncode == -signal.SIGKILL and not killed.exists()
    assert os.path.getsize(f"{killed}.part") > 0
    subprocess.run(command, check=True)
    assert killed.read_bytes() == plain.read_bytes()
