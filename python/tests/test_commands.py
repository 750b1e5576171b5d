"""The functions are the commands of `socam-host`: the same numbers, and errors that say what is wrong."""

import json
import pickle
import signal
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import typed_options
from conftest import run

import socam
from socam import options

# Times of the processor, and names of files.
_TIMES = {"cpu_s"}


def same(ours: Any, theirs: Any) -> None:
    """Compares two documents, the times that they took aside."""
    if isinstance(ours, dict):
        assert ours.keys() == theirs.keys()
        for key in ours.keys() - _TIMES:
            same(ours[key], theirs[key])
    elif isinstance(ours, list):
        assert len(ours) == len(theirs)
        for one, other in zip(ours, theirs, strict=True):
            same(one, other)
    else:
        assert ours == theirs


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory, host: Path) -> list[str]:
    """Two recordings that the command line made."""
    folder = tmp_path_factory.mktemp("files")
    paths = []
    for seed, name in [(1, "one.mcap"), (2, "two.mcap")]:
        path = str(folder / name)
        run(host, "simulate", "--profile", "multisine", "--duration", "4s", "--rate", "500", "--seed", str(seed), "-o", path)
        paths.append(path)
    return paths


def test_simulate_is_the_bench_of_the_command_line(host: Path, tmp_path: Path) -> None:
    """Up to single counts of a converter: the command line's board idles before the run, and the solver's steps differ by that."""
    path = str(tmp_path / "run.mcap")
    run(host, "simulate", "--profile", "multisine", "--duration", "4s", "--rate", "500", "--no-noise", "-o", path)
    ours, theirs = socam.simulate(duration_s=4.0, rate_hz=500.0, noise=False), socam.read(path)
    assert ours.channels == theirs.channels
    np.testing.assert_array_equal(ours["t_s"], theirs["t_s"])
    for column in ours.channels:
        counts = np.diff(np.unique(theirs[column])).min()
        differs = ours[column] != theirs[column]
        assert differs.mean() < 0.005, column
        np.testing.assert_allclose(ours[column], theirs[column], rtol=0.0, atol=1.01 * counts, err_msg=column)


def test_identify_is_that_of_the_command_line(files: list[str], host: Path) -> None:
    one, two = files
    options = ["--fix", "k3=52485", "--starts", "2", "--validate", two, "--band", "1..50", "--json"]
    theirs = json.loads(run(host, "identify", one, *options))
    recordings = [socam.read(path) for path in files]
    ours = socam.identify(recordings[0], fixed={"k3": 52485.0}, starts=2, holdout=recordings[1], band=(1.0, 50.0))
    same(json.loads(ours.to_json()), theirs)
    assert ours.converged and ours["k4"].value == theirs["parameters"][3]["value"]
    assert ours.parameters["k3"].source == "fixed"
    assert ours.to_pandas().loc["k4", "unit"] == "N m/rad"
    assert ours.model.parameters["k4"].value == pytest.approx(ours["k4"].value)
    assert "k4" in ours._repr_html_() and "k4" in repr(ours)


def test_check_is_that_of_the_command_line(files: list[str], host: Path) -> None:
    theirs = json.loads(run(host, "check", files[0], "--json"))
    ours = socam.check(files[0], "speed-o-cam")
    same(json.loads(ours.to_json()), theirs)
    assert ours.verdict == theirs["recordings"][0]["verdict"] and ours._repr_html_()


def test_a_replay_is_that_of_the_command_line(files: list[str], host: Path) -> None:
    theirs = json.loads(run(host, "simulate", "--input", files[0], "--set", "k4=120", "--json"))
    ours = socam.simulate(inputs=files[0], values={"k4": 120.0})
    same(ours.document, theirs)
    assert len(ours.recording) == theirs["rows"] and ours._repr_html_()


def test_diagnose_is_that_of_the_command_line(host: Path, tmp_path: Path) -> None:
    path, folder = str(tmp_path / "run.mcap"), tmp_path / "report"
    hide = "coulomb_friction@load_bearing:torque=0.4"
    run(host, "simulate", "--profile", "reversals", "--duration", "3s", "--rate", "250", "--hide", hide, "-o", path)
    theirs = json.loads(run(host, "diagnose", path, "--most", "1", "--why", "constant_load@load", "--json"))
    ours = socam.diagnose(path, most=1, why="constant_load@load")
    same(json.loads(ours.to_json()), theirs)
    assert ours.verdict == theirs["verdict"]
    assert [one["effect"] for one in ours.candidates if one.get("asked")] == ["constant_load"]
    assert len(ours.findings) == len(theirs["findings"])
    ours.report(folder)
    assert ours.headline in (folder / "index.html").read_text()
    html = ours._repr_html_()
    assert html.count("<img") == 2 and ours.headline in html


def test_design_is_that_of_the_command_line(host: Path) -> None:
    theirs = json.loads(run(host, "design", "--model", "two-mass", "--duration", "3s", "--json"))
    ours = socam.design("two-mass", duration_s=3.0)
    same(json.loads(ours.to_json()), theirs)
    assert len(socam.simulate("two-mass", ours.profile)) > 2000
    assert ours._repr_html_()


def test_frf_is_that_of_the_command_line(files: list[str], host: Path) -> None:
    command = ["identify", *files, "--method", "frf", "--output", "output_speed", "--band", "1..40", "--low-pass", "100:2", "--json"]
    theirs = json.loads(run(host, *command))
    ours = socam.frf(files, outputs=["output_speed"], band=(1.0, 40.0), low_pass=(100.0, 2))
    same(json.loads(ours.to_json()), theirs)
    one = ours["output_speed"]
    lines = len(theirs["outputs"][0]["lines"])
    assert one.response.shape == one.coherence.shape == (lines,) and one.phase_ci95_deg.shape == (lines, 2)
    np.testing.assert_allclose(abs(one.response), one.magnitude)
    assert one.unit == "(rad/s)/(rad/s)" and list(one.to_pandas()["magnitude_low"]) == list(one.magnitude_ci95[:, 0])
    assert ours._repr_html_().count("<img") == len(one.pictures) >= 3
    same(json.loads(socam.frf(files).to_json()), json.loads(run(host, "identify", *files, "--method", "frf", "--json")))


def test_compare_is_that_of_the_command_line(files: list[str], host: Path, tmp_path: Path) -> None:
    simulation = str(tmp_path / "simulation.csv")
    socam.simulate(inputs=files[0], values={"k4": 110.0}).recording.write(simulation)
    command = ["compare", files[0], simulation, "--offset", "0.01", "--map", "torque_in=torque_out", "--json"]
    theirs = json.loads(run(host, *command))
    ours = socam.compare(files[0], simulation, names={"torque_in": "torque_out"}, offset_s=0.01)
    same(json.loads(ours.to_json()), theirs)
    assert ours.verdict == "differ" and ours.sentences[0] in ours._repr_html_()
    ours.report(tmp_path / "report")
    assert json.loads((tmp_path / "report" / "comparison.json").read_text()) == ours.document


def test_watch_is_that_of_the_command_line(host: Path, tmp_path: Path) -> None:
    sound, worn = str(tmp_path / "sound.csv"), str(tmp_path / "worn.csv")
    for path, hide in [(sound, []), (worn, ["coulomb_friction@load_bearing:torque=0.4"])]:
        socam.simulate("two-mass", "prbs", duration_s=20.0, rate_hz=200.0, hide=hide).write(path)
    theirs = json.loads(run(host, "watch", sound, worn, "--model", "two-mass", "--baseline", sound, "--json"))
    ours = socam.watch([sound, worn], "two-mass", baseline=sound)
    same(json.loads(ours.to_json()), theirs)
    assert not ours.recordings[0]["alarms"] and ours.alarms and ours.alarms[0]["channel"] in ours._repr_html_()


def test_models() -> None:
    model = socam.Model("two-mass")
    assert "two-mass" in socam.Model.embedded() and model == socam.Model(model.text)
    held = model.fix({"stiffness": 150.0})
    assert held.parameters["stiffness"] == socam.ModelParameter(
        "stiffness", 150.0, "N m/rad", True, model.parameters["stiffness"].source
    )
    assert held != model and pickle.loads(pickle.dumps(held)) == held
    assert not model.set({"stiffness": 150.0}).parameters["stiffness"].fixed
    assert "hold" in model.between("hold").text
    assert model.with_effect("coulomb_friction", "load_bearing", torque=0.1).text.count("coulomb_friction") > 0
    assert model.drawing().startswith("<svg") and "stiffness" in model._repr_html_()


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda r: socam.Model("absent.toml"), socam.ModelError, "embedded models are"),
        (lambda r: socam.Model("schema = 3\n"), socam.ModelError, "line 1"),
        (lambda r: socam.Model("two-mass").fix(["stifness"]), socam.ModelError, "has no parameter stifness"),
        (lambda r: socam.Model("two-mass").between("cubic"), ValueError, "none of auto"),
        (lambda r: socam.identify(r, "emps"), socam.FitError, "position_m"),
        (lambda r: socam.identify(r, method="magic"), ValueError, "neither output-error"),
        (lambda r: socam.identify([r, r]), ValueError, "named twice"),
        (lambda r: socam.identify([]), socam.FitError, "no recording"),
        (lambda r: socam.identify(r, noise={"torque_in": -1.0}), ValueError, "torque_in=-1"),
        (lambda r: socam.diagnose(r, false_alarm_rate=2.0), ValueError, "between 0 and 1"),
        (lambda r: socam.simulate(profile="wobble"), ValueError, "neither a file nor built in"),
        (lambda r: socam.simulate(duration_s=0.1), ValueError, "too short"),
        (lambda r: socam.simulate(rate_hz=3e5), ValueError, "1 to 20000 Hz"),
        (lambda r: socam.simulate(hide=["rust@load"]), ValueError, "rust"),
        (lambda r: socam.simulate(duration_s="long"), TypeError, "duration_s"),
        (lambda r: socam.design(duration_s=1.0), ValueError, "2 to 600 s"),
        (lambda r: socam.frf(r, outputs=["torque"]), ValueError, "has the outputs"),
        (lambda r: socam.frf(r, period_s=-1.0), ValueError, "positive number"),
        (lambda r: socam.frf(r, low_pass=(1e6, 2)), socam.FitError, "Butterworth"),
        (lambda r: socam.compare(r, {"t_s": [0.0, 1.0], "x_m": [0.0, 1.0]}), socam.RecordingError, "no channel of the same name"),
        (lambda r: socam.compare(r, r, false_alarm_rate=0.0), ValueError, "between 0 and 1"),
        (lambda r: socam.watch(r, learn_s=1.0), socam.FitError, "needed"),
    ],
)
def test_mistakes_are_said(recording: socam.Recording, call: Any, error: type[Exception], words: str) -> None:
    with pytest.raises(error, match=words):
        call(recording)


def test_progress_is_told_and_its_exception_cancels(recording: socam.Recording) -> None:
    told: list[str] = []
    socam.identify(recording, starts=1, progress=told.append)
    assert any("step" in text for text in told)

    class Enough(Exception):
        pass

    def stop(text: str) -> None:
        raise Enough

    with pytest.raises(Enough):
        socam.identify(recording, starts=50, progress=stop)


@pytest.mark.parametrize("call", [socam.identify, socam.diagnose])
def test_ctrl_c_ends_a_call_within_a_second(call: Any) -> None:
    # Whoever starts the tests in the background lets them ignore it.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    data = socam.simulate(duration_s=20.0, hide=["coulomb_friction@load_bearing:torque=0.4"])
    pressed = []

    def press() -> None:
        pressed.append(time.monotonic())
        signal.raise_signal(signal.SIGINT)

    timer = threading.Timer(0.3, press)
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        call(data)
        time.sleep(5.0)
    assert time.monotonic() - pressed[0] < 1.0


def test_other_threads_run_during_a_fit(recording: socam.Recording) -> None:
    counts, done = [0], threading.Event()

    def count() -> None:
        while not done.is_set():
            counts[0] += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    start = time.monotonic()
    socam.identify(recording)
    elapsed = time.monotonic() - start
    done.set()
    thread.join()
    assert counts[0] > 20 * elapsed


def test_options_are_those_of_the_commands() -> None:
    """Where this fails, an option is new: `typed_options.py` writes socam/options.py."""
    assert Path(options.__file__).read_text(encoding="utf-8") == typed_options.text()


def test_every_option_of_a_command_is_one_of_its_function(files: list[str], host: Path) -> None:
    command = ["diagnose", files[0], "--fix", "k3=52485", "--set", "k4=120", "--between", "motor_speed=hold", "--most", "1", "--json"]
    theirs = json.loads(run(host, *command))
    ours = socam.diagnose(files[0], fixed={"k3": 52485.0}, start_values={"k4": 120}, between={"motor_speed": "hold"}, most=1)
    same(json.loads(ours.to_json()), theirs)
    with pytest.raises(TypeError, match="there is no option `mots`; the options are .*most"):
        socam.diagnose(files[0], mots=1)  # type: ignore[call-arg]
    with pytest.raises(TypeError, match="most: invalid type"):
        socam.diagnose(files[0], most="many")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="most: 7 is not in 1..=6"):
        socam.diagnose(files[0], most=7)
