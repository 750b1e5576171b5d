"""Loads a log into Rerun: its own check finds nothing, and every sample arrives.

Usage: read_rerun.py LOG.mcap EXPECTED.csv
"""

import pathlib
import re
import subprocess
import sys
import tempfile


def rerun(*arguments):
    program = pathlib.Path(sys.executable).with_name("rerun")
    return subprocess.run([program, *arguments], check=True, capture_output=True, text=True).stdout


def main():
    path, expected = sys.argv[1:]
    with open(expected) as file:
        rows = sum(1 for _ in file) - 1
    verdicts = [line.split() for line in rerun("mcap", "check", path).splitlines() if "/socam/" in line]
    assert verdicts and all(words[0] == "ok" and words[-1] == "—" for words in verdicts), verdicts
    with tempfile.TemporaryDirectory() as folder:
        target = str(pathlib.Path(folder) / "log.rrd")
        rerun("mcap", "convert", path, "-o", target)
        chunks = re.findall(
            r"with (\d+) rows .* - /socam/sample - data columns: \[socam.Sample", rerun("rrd", "print", target)
        )
    assert sum(map(int, chunks)) == rows, (chunks, rows)
    print(f"{rows} samples loaded")


main()
