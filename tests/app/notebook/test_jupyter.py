"""A real Jupyter server: who gets through its login to the lab, and the example notebooks in its kernels."""

import asyncio
import http.client
import importlib.util
import re
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import psutil
import pytest

from app.server.web.access import Access
from app.server.web.guard import open_server, quiet
from tests.jupyter import Jupyter, join, jupyter

# Imported by the tests, as it takes seconds and each process of the tests collects this file.
for package in ("jupyter_server_proxy", "nbformat", "nbclient", "jupyter_client"):
    if importlib.util.find_spec(package) is None:
        pytest.skip("the extras jupyter and test are not installed", allow_module_level=True)
OPTIONS = ("--ServerApp.jpserver_extensions={'jupyter_server_proxy': True}", "--ServerApp.allow_remote_access=True")
PAGE = "springtide/index.html"
ROOT = Path(__file__).parents[3]
NOTEBOOKS = sorted((ROOT / "docs" / "notebooks").glob("*.ipynb"))
WITHOUT_LAB = ("barge", "blender", "pendulum")


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Jupyter]:
    with jupyter(tmp_path_factory.mktemp("jupyter"), "/user/ada/", *OPTIONS) as server:
        yield server


def get(port: int, path: str, **headers: str) -> tuple[int, str, str]:
    """Status, body and cookies of a page."""
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
    connection.request("GET", path, headers=headers)
    answer = connection.getresponse()
    cookies = "; ".join(re.findall(r"(?:^|, )([^=;, ]+=[^;]+);", answer.getheader("Set-Cookie") or ""))
    return answer.status, answer.read().decode("utf-8", "replace"), cookies


def run(server: Jupyter, notebook: Any) -> Any:
    """Execute a notebook in a kernel of the server, and return it with its outputs; fails where a cell does."""
    import nbclient
    from jupyter_client.asynchronous.client import AsyncKernelClient

    async def execute(connection: Path) -> None:
        client = nbclient.NotebookClient(notebook, timeout=600)
        client.kc = AsyncKernelClient()
        client.kc.load_connection_file(str(connection))
        client.kc.start_channels(hb=False)
        try:
            await client.kc.wait_for_ready(timeout=60)
            for number, cell in enumerate(notebook.cells):
                await client.async_execute_cell(cell, number)
        finally:
            client.kc.stop_channels()

    kernel = server.ask("api/kernels", "POST")["id"]
    try:
        asyncio.run(execute(server.runtime / f"kernel-{kernel}.json"))
    finally:
        server.ask(f"api/kernels/{kernel}", "DELETE")
    return notebook


def outputs(notebook: Any) -> list[Any]:
    return [output for cell in notebook.cells for output in cell.get("outputs", [])]


def test_the_lab_opens_with_the_token_and_for_nobody_else(server: Jupyter) -> None:
    below, own = f"{server.base}{PAGE}", f"http://127.0.0.1:{server.port}"
    assert get(server.port, below)[0] in (302, 403)
    status, page, cookies = get(server.port, f"{below}?token={server.token}")
    assert (status, "springtide-cover" in page) == (200, True)
    assert join(server.port, below, own, Cookie=cookies) == 101
    assert join(server.port, below, own) == 403
    assert join(server.port, below, "http://evil.example", Cookie=cookies) == 403
    # One lab for this student, however many pages; without the key its own port answers nobody.
    labs = [p for p in psutil.Process(server.process.pid).children(recursive=True) if "--no-open" in p.cmdline()]
    assert len(labs) == 1
    port = int(labs[0].cmdline()[-1])
    assert get(port, "/")[0] == get(port, "/", Cookie=cookies)[0] == 403
    for origin in (own, f"http://127.0.0.1:{port}", "http://evil.example"):
        assert join(port, "/", origin) == 403


@pytest.mark.parametrize(
    ("access", "status"),
    [
        (Access(), 0),
        (Access(origins=("http://hub.example.org",)), 0),
        (Access(origins=("http://hub.example.org:{port}",)), 101),
        (Access(key="k" * 16), 101),
    ],
)
def test_a_lab_behind_a_proxy_of_another_name_takes_a_setting(server: Jupyter, access: Access, status: int) -> None:
    origins = tuple(origin.format(port=server.port) for origin in access.origins)
    host = f"hub.example.org:{server.port}"  # by which Jupyter names its cookie
    cookies = get(server.port, f"{server.base}api/status?token={server.token}", Host=host)[2]
    own = open_server("127.0.0.1", 0, access._replace(origins=origins)).server
    try:
        path = f"{server.base}proxy/{own.get_port()}/{access.key and access.key + '/'}index.html"
        assert join(server.port, path, f"http://{host}", "hub.example.org", Cookie=cookies) == status
        assert join(server.port, path, "http://evil.example", "hub.example.org", Cookie=cookies) == 403
    finally:
        with quiet():
            own.stop()


def test_the_examples_are_there_and_are_no_other_than_what_is_tested() -> None:
    import nbformat

    assert [path.stem for path in NOTEBOOKS] == ["barge", "blender", "pendulum", "race", "rope", "sea"]
    for path in NOTEBOOKS:
        notebook = nbformat.read(path, as_version=4)
        nbformat.validate(notebook)
        assert ("app.show(" in "".join(cell.source for cell in notebook.cells)) == (path.stem not in WITHOUT_LAB)
        assert not any(cell.get("outputs") for cell in notebook.cells)


@pytest.mark.parametrize("stem", WITHOUT_LAB)
def test_a_notebook_of_the_library_runs(stem: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In this process, as it shows no lab."""
    import nbformat

    pytest.importorskip("xarray")
    pytest.importorskip("matplotlib").use("Agg")
    monkeypatch.chdir(tmp_path)
    names: dict = {}
    for cell in nbformat.read(ROOT / "docs" / "notebooks" / f"{stem}.ipynb", as_version=4).cells:
        if cell.cell_type == "code":
            exec(compile(cell.source, f"{stem}.ipynb", "exec"), names)


def test_two_labs_in_a_notebook_and_a_cell_that_is_run_again(server: Jupyter) -> None:
    import nbformat

    code = (
        "import threading\nimport app\nrope = app.show('rope', stiffness=2000, paused=True)",
        "other = app.show('rope', paused=True)\nrope.wait(0.5)\nother.wait(0.25)",
        "print(round(rope.time, 6), round(other.time, 6), rope.address != other.address)",
        "rope.stop()\nother.wait(0.25)\nprint(round(other.time, 6), rope)",
        "try:\n    app.show('rope', stiffness=-1)\nexcept ValueError as reason:\n    print(reason)",
        "other.stop()\nprint([t.name for t in threading.enumerate() if t.name in ('simulation', 'viewer')])",
    )
    done = run(server, nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(text) for text in code]))
    found = outputs(done)
    assert all(output.output_type != "error" for output in found)
    said = "".join(output.get("text", "") for output in found if output.output_type == "stream").splitlines()
    assert said == [
        "0.5 0.25 True",
        "0.5 <a lab that was stopped>",
        "stiffness: -1 is not allowed; allowed: 1 to 1e9 N/m",
        "[]",
    ]
    shown = [output.data for output in found if output.output_type == "display_data"]
    assert len(shown) == 4  # a page and a place for a picture, twice
    assert "viser" not in str(shown)
    assert shown[0]["text/plain"] == "This lab was stopped."  # no browser has drawn it


@pytest.mark.stress
@pytest.mark.timeout(1200)
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_an_example_runs_clean(server: Jupyter, path: Path) -> None:
    import nbformat

    start = time.monotonic()
    done = run(server, nbformat.read(path, as_version=4))
    print(f"{path.stem}: {time.monotonic() - start:.1f} s")
    for output in outputs(done):
        assert output.output_type != "error"
        assert output.get("name") != "stderr", output
    assert any("image/png" in output.get("data", {}) for output in outputs(done))  # its figures


@pytest.mark.stress
def test_a_kernel_that_restarts_or_ends_leaves_no_process(server: Jupyter) -> None:
    from jupyter_client.blocking.client import BlockingKernelClient

    kernel = server.ask("api/kernels", "POST")["id"]
    connection = server.runtime / f"kernel-{kernel}.json"
    for ending in ("restart", "DELETE"):
        client = BlockingKernelClient()
        client.load_connection_file(str(connection))
        client.start_channels(hb=False)
        client.wait_for_ready(timeout=60)
        reply = client.execute_interactive(
            "import app\nlab = app.show('cloth')", timeout=200, output_hook=lambda _: None
        )
        assert reply["content"]["status"] == "ok"
        below = psutil.Process(server.process.pid).children(recursive=True)
        client.stop_channels()
        if ending == "restart":
            server.ask(f"api/kernels/{kernel}/restart", "POST")
        else:
            server.ask(f"api/kernels/{kernel}", "DELETE")
        _, alive = psutil.wait_procs(below, timeout=15)
        assert [p.pid for p in alive if p.status() != psutil.STATUS_ZOMBIE] == []
