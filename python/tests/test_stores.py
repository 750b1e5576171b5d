"""Recordings in stores: in memory, behind a web server, and in S3 where `moto` is installed; and what goes wrong there."""

import http.server
import os
import sys
import threading
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any
from urllib.parse import quote, urlsplit

import fsspec
import numpy as np
import pyarrow.parquet
import pytest
from fsspec.registry import _registry

import socam
import socam.fleet
import socam.ray
from socam import _files, _socam

MODEL = "two-mass"
# What names of files may hold and addresses may not.
STRANGE = "SN7/run #1 100% é?&+=[x].csv"


@dataclass
class Store:
    """A place for files: `put` writes one, `uri` is that of a name."""

    root: str
    put: Callable[[str, bytes], object]
    options: dict[str, Any] = field(default_factory=dict)
    quoted: bool = False

    def uri(self, name: str) -> str:
        return f"{self.root}/{quote(name) if self.quoted else name}"


class Handler(http.server.SimpleHTTPRequestHandler):
    """Files of a folder. `failures` says how often a file is refused before it is there: with a status, or cut off in mid-file."""

    failures: dict[str, tuple[int, int]] = {}

    def do_GET(self) -> None:
        name = urlsplit(self.path).path.rpartition("/")[2]
        status, left = self.failures.get(name, (0, 0))
        if left > 0:
            self.failures[name] = (status, left - 1)
            if status:
                return self.send_error(status)
            self.send_response(200)
            self.send_header("Content-Length", "1000000")
            self.end_headers()
            self.wfile.write(b"t_s,load_speed_rad_s\n0,1\n")
            self.close_connection = True
            return None
        return super().do_GET()

    def log_message(self, format: str, *args: object) -> None:
        pass


def in_memory() -> Iterator[Store]:
    system = fsspec.filesystem("memory")
    yield Store("memory://fleet", lambda name, content: system.pipe_file(f"/fleet/{name}", content))
    system.rm("/fleet", recursive=True)


def on_the_web(folder: Path) -> Iterator[Store]:
    pytest.importorskip("aiohttp", reason="fsspec's web addresses need aiohttp")

    def put(name: str, content: bytes) -> None:
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), partial(Handler, directory=str(folder)))
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    yield Store(f"http://127.0.0.1:{server.server_port}", put, quoted=True)
    server.shutdown()
    server.server_close()


def in_s3() -> Iterator[Store]:
    reason = "S3 is tried where moto and s3fs are installed: pip install 'moto[s3]' flask flask-cors s3fs"
    pytest.importorskip("s3fs", reason=reason)
    moto = pytest.importorskip("moto.server", reason=reason)
    server = moto.ThreadedMotoServer(ip_address="127.0.0.1", port=0, verbose=False)
    server.start()
    host, port = server.get_host_and_port()
    options = {"key": "someone", "secret": "secret", "endpoint_url": f"http://{host}:{port}"}
    system = fsspec.filesystem("s3", **options)
    system.makedirs("bucket", exist_ok=True)
    yield Store("s3://bucket/fleet", lambda name, content: system.pipe_file(f"bucket/fleet/{name}", content), options)
    server.stop()


@pytest.fixture(scope="module", params=["memory", "http", "s3"])
def store(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Store]:
    """Each kind of store."""
    makes: dict[str, Callable[[], Iterator[Store]]] = {
        "memory": in_memory,
        "http": lambda: on_the_web(tmp_path_factory.mktemp("web")),
        "s3": in_s3,
    }
    yield from makes[request.param]()


@pytest.fixture
def web(tmp_path: Path) -> Iterator[Store]:
    """A web server of its own."""
    Handler.failures.clear()
    yield from on_the_web(tmp_path / "web")


@pytest.fixture(scope="module")
def content(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """A recording, as a file."""
    path = tmp_path_factory.mktemp("one") / "run.csv"
    socam.simulate(MODEL, "prbs", duration_s=3.0, rate_hz=200.0, seed=1).write(path)
    return path.read_bytes()


@pytest.fixture(autouse=True)
def impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    """The attempts follow at once."""
    monkeypatch.setattr(_files, "_PAUSES_S", (0.01, 0.01))


def test_a_store_has_the_recordings_of_a_folder(store: Store, content: bytes, tmp_path: Path) -> None:
    store.put(STRANGE, content)
    store.put("SN8/2026-01-02.csv", content)
    store.put("SN8/.hidden.csv", content)
    store.put("SN8/notes.txt", b"nothing")
    read = socam.read(store.uri(STRANGE), storage_options=store.options)
    np.testing.assert_array_equal(read["load_speed"], socam.read(content)["load_speed"])
    row = socam.fleet.diagnose_one(store.uri(STRANGE), MODEL, name=STRANGE, storage_options=store.options)
    local = socam.fleet.diagnose_one(content, MODEL, name=STRANGE)
    assert row.document == local.document and row.status == "ok"
    every = [STRANGE, "SN8/2026-01-02.csv"]

    def names(places: socam.ray.Places) -> list[str]:
        return [one.name for one in socam.ray.recordings(places, storage_options=store.options)]

    assert names(store.root) == names([store.uri(name) for name in every]) == every
    assert set(every) <= set(names(store.root + "/**/*.csv"))
    store.put("list.csv", f'file,machine,date\n"{STRANGE}",7,1970-01-02\n{store.uri(every[1])},,\n'.encode())
    listed = {one.name: one for one in socam.ray.recordings(store.uri("list.csv"), storage_options=store.options)}
    assert (listed[STRANGE].machine, listed[STRANGE].date_ms) == ("7", 86_400_000)
    for one in listed.values():
        assert socam.fleet.diagnose_one(one.place, MODEL, name="x", storage_options=store.options).id == local.id
    # Lists of this machine may name files of a store.
    (tmp_path / "list.csv").write_text(f"file\n{store.uri(every[1])}\n")
    assert [one.place for one in socam.ray.recordings(tmp_path / "list.csv")] == [store.uri(every[1])]


def test_what_is_missing_is_one_sentence_or_a_row(store: Store) -> None:
    uri = store.uri("SN9/absent.csv")
    with pytest.raises(socam.RecordingError) as raised:
        socam.read(uri, storage_options=store.options)
    assert str(raised.value) in (f"`{uri}` cannot be read: there is no such file", f"`{uri}` cannot be read: The specified key does not exist")
    row = socam.fleet.diagnose_one(uri, MODEL, name="SN9/absent.csv", storage_options=store.options)
    assert (row.status, row.document["machine"]) == ("unreadable", "SN9") and row.message.startswith("the file cannot be read: ")
    with pytest.raises(ValueError, match="there is no recording in"):
        socam.ray.recordings(store.uri("SN9/*.nothing"), storage_options=store.options)


def test_s3_without_bucket_or_server_or_with_an_environment(content: bytes, monkeypatch: pytest.MonkeyPatch) -> None:
    stores = in_s3()
    store = next(stores)
    store.put("run.csv", content)
    with pytest.raises(socam.RecordingError, match="absent/run.csv` cannot be read: .*bucket does not exist$"):
        socam.read("s3://absent/run.csv", storage_options=store.options)
    with pytest.raises(socam.SocamError, match="bucket does not exist$"):
        socam.ray.recordings("s3://absent/fleet", storage_options=store.options)
    refused = store.options | {"endpoint_url": "http://127.0.0.1:9", "config_kwargs": {"retries": {"max_attempts": 0}}}
    with pytest.raises(socam.RecordingError, match="cannot be read: Could not connect to the endpoint URL"):
        socam.read(store.uri("run.csv"), storage_options=refused)
    for name, value in {"KEY": "key", "SECRET": "secret", "ENDPOINT_URL": "endpoint_url"}.items():
        monkeypatch.setenv(f"FSSPEC_S3_{name}", store.options[value])
    fsspec.config.set_conf_env(fsspec.config.conf)
    try:
        assert len(socam.read(store.uri("run.csv"))) == len(socam.read(content))
    finally:
        fsspec.config.conf.pop("s3", None)
    next(stores, None)


@pytest.mark.parametrize("status", [503, 0])
def test_a_web_server_that_fails_twice_is_asked_again(web: Store, content: bytes, status: int) -> None:
    web.put("run.csv", content)
    Handler.failures["run.csv"] = (status, 2)
    assert len(socam.read(web.uri("run.csv"))) == len(socam.read(content))
    assert Handler.failures["run.csv"] == (status, 0)
    # What is forbidden stays so.
    Handler.failures["run.csv"] = (403, 5)
    with pytest.raises(socam.RecordingError, match=r"/run.csv` cannot be read: the server answers 403 Forbidden$"):
        socam.read(web.uri("run.csv") + "?Signature=secret")
    assert Handler.failures["run.csv"] == (403, 4)


def here(found: list[socam.ray.Recording], made_with: Any, part: _socam.FleetPart, workers: int | None) -> Iterable[tuple[str, str, bytes]]:
    """The rows without Ray."""
    model, options, seed, storage_options = made_with
    task = _socam.FleetTask(_socam.Model(model), options, seed)
    known = part.known()
    for one in found:
        ids = [id_ for name, id_ in known if name == one.name]
        about = {"machine": one.machine, "date_ms": one.date_ms, "known": ids}
        id_, row = socam.fleet.row_of(task, one.name, one.place, storage_options, **about)
        yield one.name, id_, b"" if row is None else row.to_bytes()


def test_what_the_network_took_is_tried_again(web: Store, content: bytes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A recording that could not be fetched is no row for ever: neither in a run that goes on, nor in one over its table."""
    monkeypatch.setattr(socam.ray, "_rows", here)
    for name in ["a.csv", "b.csv", "c.csv"]:
        web.put(name, content)
    out = tmp_path / "fleet.parquet"

    def run(failing: dict[str, tuple[int, int]]) -> list[str]:
        Handler.failures = dict(failing)
        assert socam.ray.diagnose(web.root, MODEL, out) == 3
        table = pyarrow.parquet.read_table(out)
        return list(table["status"].to_pylist())

    class Ended(Exception):
        pass

    def end(text: str) -> None:
        if text.startswith("2 of"):
            raise Ended

    Handler.failures = {"b.csv": (503, 99)}
    with pytest.raises(Ended):
        socam.ray.diagnose(web.root, MODEL, out, progress=end)
    assert os.path.getsize(f"{out}.part") > 0
    assert run({"c.csv": (500, 99)}) == ["ok", "ok", "unreadable"]
    assert run({"c.csv": (503, 99)}) == ["ok", "ok", "unreadable"]
    assert pyarrow.parquet.read_table(out)["message"][2].as_py() == "the file cannot be read: the server answers 503 Service Unavailable"
    assert run({}) == ["ok", "ok", "ok"]
    # The same bytes as without a failure.
    whole = tmp_path / "whole.parquet"
    socam.ray.diagnose(web.root, MODEL, whole)
    assert whole.read_bytes() == out.read_bytes()


@pytest.mark.parametrize(
    ("uri", "error", "words"),
    [
        ("s3://bucket/run.csv", ImportError, "needs s3fs: pip install s3fs"),
        ("gs://bucket/run.csv", ImportError, "needs gcsfs: pip install gcsfs"),
        ("nowhere://bucket/run.csv", ValueError, "Protocol not known: nowhere"),
        ("s3://bucket/run.csv?endpoint_override=localhost", ValueError, "`endpoint_override` is an option of pyarrow"),
        ("http://127.0.0.1:9/run.csv?token=secret", socam.RecordingError, "`http://127.0.0.1:9/run.csv` cannot be read: .*[Cc]onnect"),
    ],
)
def test_a_store_that_cannot_be_used_is_said(uri: str, error: type[Exception], words: str, monkeypatch: pytest.MonkeyPatch) -> None:
    for module, protocol in [("s3fs", "s3"), ("gcsfs", "gs")]:
        monkeypatch.setitem(sys.modules, module, None)
        monkeypatch.delitem(_registry, protocol, raising=False)
    with pytest.raises(error, match=words) as raised:
        socam.read(uri)
    assert "secret" not in str(raised.value) and "\n" not in str(raised.value)
    row = socam.fleet.diagnose_one(uri, MODEL)
    assert row.status == "unreadable" and "secret" not in row.to_arrow().to_pandas().to_csv()
    if error is not socam.RecordingError:
        with pytest.raises(error, match=words):
            socam.ray.recordings([uri])
