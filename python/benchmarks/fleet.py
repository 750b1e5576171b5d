"""A virtual fleet on Ray: makes recordings, diagnoses them, and kills workers and driver on the way.

    python benchmarks/fleet.py make FOLDER --count 2000
    python benchmarks/fleet.py run FOLDER ray.parquet --workers 2
    python benchmarks/fleet.py run FOLDER killed.parquet --workers 2 --kill-worker 500 --kill-driver 1000
    python benchmarks/fleet.py run FOLDER killed.parquet --workers 2          # goes on where it was
    socam-host fleet FOLDER --model two-mass -o plain.parquet --jobs 1
    cmp plain.parquet ray.parquet && cmp plain.parquet killed.parquet
"""

import argparse
import os
import signal
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import socam
import socam.ray

HIDDEN = [
    "coulomb_friction@load_bearing:torque=0.1",
    "sensor_gain@load_speed:gain=0.95",
]


def make_one(folder: str, model: str, number: int) -> None:
    """One recording of 2 s at 200 Hz; every twentieth is of a machine with something hidden, every fiftieth file is no recording."""
    machine = Path(folder) / f"SN{number % 100:03}"
    machine.mkdir(parents=True, exist_ok=True)
    path = machine / f"{number:06}.csv"
    if number % 50 == 49:
        path.write_bytes(b"t_s,load_speed_rad_s\n0,broken\n")
        return
    hide = [HIDDEN[number // 20 % len(HIDDEN)]] if number % 20 == 7 else []
    socam.simulate(model, "prbs", duration_s=3.0, rate_hz=200.0, seed=number + 1, hide=hide).write(path)


def workers() -> list[int]:
    """Processes of the actors on this machine."""
    found = []
    for entry in Path("/proc").iterdir():
        try:
            if b"ray::" in (line := (entry / "cmdline").read_bytes()) and b"_Worker" in line:
                found.append(int(entry.name))
        except (OSError, ValueError):
            continue
    return sorted(found)


def main() -> None:
    """See the module's text."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("action", choices=["make", "run"])
    parser.add_argument("folder")
    parser.add_argument("table", nargs="?")
    parser.add_argument("--model", default="two-mass")
    parser.add_argument("--count", type=int, default=2000)
    parser.add_argument("--workers", type=int)
    parser.add_argument("--reference", nargs="*", default=[])
    parser.add_argument("--kill-worker", type=int, default=0, help="kill a worker after this many rows")
    parser.add_argument("--kill-driver", type=int, default=0, help="kill the driver after this many rows")
    arguments = parser.parse_args()
    start = time.monotonic()
    if arguments.action == "make":
        with ProcessPoolExecutor(arguments.workers) as pool:
            numbers = range(arguments.count)
            list(pool.map(make_one, [arguments.folder] * arguments.count, [arguments.model] * arguments.count, numbers))
        print(f"{arguments.count} files in {time.monotonic() - start:.1f} s")
        return
    rows, first = 0, 0.0

    def told(text: str) -> None:
        nonlocal rows, first
        rows += 1
        first = first or time.monotonic()
        if rows == arguments.kill_worker:
            # Ray's own processes have other names.
            victim = workers()[0]
            print(f"after {rows} rows the worker {victim} is killed", file=sys.stderr)
            os.kill(victim, signal.SIGKILL)
        if rows == arguments.kill_driver:
            print(f"after {rows} rows the driver is killed", file=sys.stderr)
            os.kill(os.getpid(), signal.SIGKILL)

    count = socam.ray.diagnose(
        arguments.folder, arguments.model, arguments.table, workers=arguments.workers, reference=arguments.reference, progress=told
    )
    end = time.monotonic()
    print(f"{count} rows in {end - start:.1f} s; {(end - first) / max(count - 1, 1) * 1000:.1f} ms a row after the first")


if __name__ == "__main__":
    main()
