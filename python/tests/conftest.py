"""What the tests share: a simulated bench, the command line where it is built, and the repository."""

import os
import subprocess
from pathlib import Path

import pytest

import socam

TRUTH = {"k4": 134.07}
RIG = "two-mass"


@pytest.fixture(scope="session")
def recording() -> socam.Recording:
    """A short recording of a small rig: torque in, two speeds out."""
    return socam.simulate("speed-o-cam", "multisine", duration_s=4.0, rate_hz=500.0, seed=7)


@pytest.fixture(scope="session")
def host() -> Path:
    """The program `socam-host`, of the same sources: SOCAM_HOST, or that of the target folder."""
    root = Path(__file__).resolve().parents[2]
    target = Path(os.environ.get("CARGO_TARGET_DIR", root / "target"))
    program = Path(os.environ.get("SOCAM_HOST", target / "release" / "socam-host"))
    if not program.exists():
        pytest.skip(f"there is no {program} to compare with")
    return program


def run(program: Path, *arguments: str) -> str:
    """What the program prints."""
    done = subprocess.run([program, *arguments], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout
