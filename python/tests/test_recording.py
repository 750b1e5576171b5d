"""Recordings: in and out, without copies."""

from pathlib import Path

import numpy as np
import pandas
import polars
import pyarrow
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import socam


def test_views_share_the_recordings_memory(recording: socam.Recording) -> None:
    name = recording.channels[0]
    address = recording[name].__array_interface__["data"][0]
    assert recording[name].__array_interface__["data"] == (address, True)
    assert recording.to_arrow()[name].chunk(0).buffers()[1].address == address
    assert recording.to_polars()[name].to_numpy(allow_copy=False).__array_interface__["data"][0] == address
    frame = recording.to_pandas()
    assert frame[name].to_numpy().__array_interface__["data"][0] == address
    assert list(frame.columns) == ["t_s", *recording.channels]
    with pytest.raises(ValueError, match="read-only"):
        recording[name][0] = 1.0


def test_an_array_outlives_its_recording() -> None:
    column = socam.read({"t_s": np.arange(1000.0), "x_rad": np.arange(1000.0) ** 2})["x"]
    assert column[999] == 998001.0


@pytest.mark.parametrize("make", [dict, pandas.DataFrame, polars.DataFrame, pyarrow.table])
def test_a_table_of_any_kind_is_a_recording(make: type) -> None:
    columns = {"t_s": [0.0, 0.1, 0.3], "force_N": [1.0, float("nan"), 3.0], "x_m": [1, 2, 3]}
    read = socam.read(make(columns), name="table")
    assert (read.name, read.channels, read.units["force_N"]) == ("table", ["force_N", "x_m"], "N")
    np.testing.assert_array_equal(read["force_N"], columns["force_N"])
    assert read.to_arrow()["force_N"].null_count == 1
    assert read.to_polars()["force_N"].null_count() == 1
    again = socam.read(read.to_arrow())
    np.testing.assert_array_equal(again["force"], columns["force_N"])


@pytest.mark.parametrize(
    ("source", "error", "words"),
    [
        ({"t_s": [0.0, 0.1], "speed": [1.0, 2.0]}, ValueError, "`speed` does not say its unit"),
        ({"x_m": [0.0]}, ValueError, "no times `t_s`"),
        ({"t_s": [0.0, 0.0], "x_m": [1.0, 2.0]}, ValueError, "must increase"),
        ({"t_s": [0.0, 1.0], "x_m": [1.0]}, ValueError, "1 values for 2 times"),
        ({"t_s": [0.0], "x_m": ["a"]}, TypeError, "does not hold numbers"),
        ({"t_s": [[0.0]], "x_m": [1.0]}, ValueError, "expected \\(rows,\\)"),
        (3, TypeError, "not from int"),
        (b"no recording", socam.RecordingError, "memory"),
        ("absent.csv", socam.RecordingError, "there is no such file"),
        ("run.csv@2..1", ValueError, "2..1"),
    ],
)
def test_what_is_no_recording_is_said(source: object, error: type[Exception], words: str) -> None:
    with pytest.raises(error, match=words):
        socam.read(source)


def test_files_and_their_bytes_are_the_same(recording: socam.Recording, tmp_path: Path) -> None:
    for name in ["run.csv", "run.mcap"]:
        path = tmp_path / name
        recording.write(path)
        for read in [socam.read(path), socam.read(path.read_bytes(), name="bytes"), socam.read(path.as_uri())]:
            assert len(read) == len(recording)
            for column in recording.keys():
                np.testing.assert_array_equal(read[column], recording[column])
        assert socam.read(path.read_bytes(), name="bytes").name == "bytes"
    part = socam.read(f"{tmp_path / 'run.csv'}@1..2")
    assert (part["t_s"][0], len(part)) == (1.0, 500)
    with pytest.raises(ValueError, match="csv or .mcap"):
        recording.write(tmp_path / "run.txt")
    with pytest.raises(KeyError, match="nothing"):
        recording["nothing"]


finite = st.floats(allow_nan=True, allow_infinity=False, width=64)


@settings(max_examples=50, deadline=None)
@given(st.lists(finite, min_size=1, max_size=200), st.floats(1e-6, 1e3))
def test_columns_come_back_bit_for_bit(values: list[float], step_s: float) -> None:
    given_ = {"t_s": step_s * np.arange(len(values)), "x_rad": np.array(values)}
    read = socam.read(given_)
    np.testing.assert_array_equal(read["t_s"], given_["t_s"])
    np.testing.assert_array_equal(read["x_rad"], given_["x_rad"])
    np.testing.assert_array_equal(read.to_arrow()["x_rad"].to_numpy(), given_["x_rad"])


@settings(max_examples=100, deadline=None)
@given(st.binary(max_size=300))
def test_bytes_are_a_recording_or_an_error(content: bytes) -> None:
    try:
        assert len(socam.read(content)) > 0
    except socam.RecordingError as error:
        assert "memory" in str(error) and "/tmp" not in str(error)


def test_a_notebook_shows_it(recording: socam.Recording) -> None:
    html = recording._repr_html_()
    assert html.count("<svg") == len(recording.channels) and recording.channels[0] in html
