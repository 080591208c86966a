"""What the pages name is there: links, files, tests, commands, options; and the pages keep to their form."""

import argparse
import itertools
import json
import re
from collections.abc import Iterator
from types import SimpleNamespace
from unittest import mock

import pytest

from app.__main__ import Parser, make_parser
from app.notebook.server_proxy import LAB_VARIABLE
from app.scenes import NAMES, scene_named
from app.scenes.setups import CHANGES, FILE_KEYS, FILES, read_file
from benchmarks.command import benchmarks
from sim.parameters import parameters_of
from sim.springs import INTEGRATORS
from tests.docs.pages import PAGES, ROOT, TEST, commands, links, named_tests, paths, prose_of, text_of
from tests.examples import section

MAX_README_LINES = 120
MAX_CELL_WORDS = 15
README_COMMANDS = (
    "python3 -m venv .venv && .venv/bin/pip install . && .venv/bin/springtide",
    "python3 -m venv .venv && .venv/bin/pip install '.[test]' && .venv/bin/python -m pytest -n 2",
)
OF_ONE_MACHINE = re.compile(r"/(?:work|tmp|home|root)/")
HOST = re.compile(r"\b(?:[\w-]+\.)+(?:com|dev|io|net|org)\b")
ALLOWED_HOSTS = {"hub.example.org", "keepachangelog.com", "semver.org"}  # examples and standards
# Added by the examples of docs/contributing.md, to a copy.
EXAMPLES = {
    block.path for heading in re.findall(r"^## (Add .+)$", text_of(ROOT / "docs" / "contributing.md"), re.MULTILINE)
    for block in section(heading)
}  # fmt: skip
EXAMPLE_FOLDERS = {path.rpartition("/")[0] for path in EXAMPLES}


def subcommands() -> dict[str, Parser]:
    """The parser of each sub-command; "" is serving."""
    parser = make_parser()
    return {"": parser, **dict(parsers_below(parser))}


def parsers_below(parser: Parser, prefix: str = "") -> Iterator[tuple[str, Parser]]:
    """The sub-commands of a parser, and theirs: `lab` and `lab new`."""
    for action in parser._actions:
        for name, inner in action.choices.items() if isinstance(action, argparse._SubParsersAction) else ():
            inner.add_arguments()
            yield prefix + name, inner
            yield from parsers_below(inner, f"{prefix}{name} ")


def test_links_files_and_tests_of_the_pages_are_there():
    assert not [link for link in links() if not ((ROOT / link.page).parent / link.what.partition("#")[0]).exists()]
    added = EXAMPLES | EXAMPLE_FOLDERS
    assert not [path for path in set(paths()) if not (ROOT / path.what).exists() and path.what not in added]
    for named in set(named_tests()):
        path, name = TEST.fullmatch(named.what).groups()
        assert re.search(rf"^(?:async )?def {name}\(", (ROOT / path).read_text("utf-8"), re.MULTILINE), named


@pytest.mark.parametrize("named", sorted(set(commands())), ids=str)
def test_a_command_has_its_sub_command_and_options(named):
    parsers = subcommands()
    words = re.sub(r"[\[\]]", "", named.what.partition("#")[0]).split()[1:]
    command = next((name for name in (" ".join(words[:2]), *words[:1]) if name in parsers), "")
    if words and not words[0].startswith("-"):
        assert command, f"no sub-command {words[0]}"
    known = parsers[command]._option_string_actions
    for word in words:
        if word.startswith("--"):
            assert word in known, word
    added = {path.split("/")[2] for path in EXAMPLES if path.startswith("app/scenes/")}
    for option, value in itertools.pairwise(words):
        if option in ("--scene", "run") and value.islower():
            assert value in {*NAMES, *added}
        if option == "--set" and command == "run" and words[1] in NAMES and named.page != "docs/contributing.md":
            assert value.partition("=")[0] in parameters_of(scene_named(words[1]).params)
    if command == "bench":
        values = min((words.index(option) for option in ("--out", "--peers") if option in words), default=len(words))
        assert {word for word in words[1:values] if word.islower() and not word.startswith("-")} <= set(benchmarks())


def test_the_readme_is_short_and_has_its_two_commands():
    readme = text_of(ROOT / "README.md")
    assert len(readme.splitlines()) <= MAX_README_LINES
    for command in README_COMMANDS:
        assert f"```sh\n{command}\n```" in readme


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_a_table_cell_has_at_most_15_words(page):
    for line in prose_of(page).splitlines():
        for cell in re.split(r"(?<!\\)\|", line.strip("|")) if line.startswith("|") else ():
            assert len(cell.split()) <= MAX_CELL_WORDS, cell


def test_figures_of_the_readme_are_those_of_the_measurements():
    """Each number of the list of differences stands in measured.md too."""
    readme, measured = text_of(ROOT / "README.md"), text_of(ROOT / "docs" / "measured.md")
    (claims,) = re.findall(r"^## What makes it different\n(.*?)^## ", readme, re.MULTILINE | re.DOTALL)
    figures = set(
        re.findall(r"(?<![\w.])\d[\d,.e-]*\d(?![\w.])|(?<![\w.])\d(?![\w.,])", claims.partition("All figures")[0])
    )
    assert len(figures) > 10
    assert not [figure for figure in figures if not re.search(rf"(?<![\w.]){re.escape(figure)}(?![\w]|\.\d)", measured)]


def test_the_set_up_file_of_the_page_is_read_back():
    (block,) = re.findall(r"^```json\n(.*?)^```$", text_of(ROOT / "docs" / "share.md"), re.MULTILINE | re.DOTALL)
    setup = read_file(block, "docs/share.md")
    assert set(json.loads(block)) == set(FILE_KEYS) - {*FILES, CHANGES}  # of other files
    assert setup.camera == ((0.5, -4.0, 2.0), (0.0, 0.0, 1.3))


def test_the_hub_of_the_class_starts_what_is_there():
    """Both ways to run it: its configuration, and the image that it names."""
    page = text_of(ROOT / "docs" / "class.md")
    common, *ways = re.findall(r"^```python\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)
    for way in ways:
        config = mock.MagicMock()
        exec(common + way, {"c": config})
        assert {LAB_VARIABLE} <= config.Spawner.environment.keys() <= {LAB_VARIABLE, "SPRINGTIDE_DATA"}
        folder = config.Spawner.environment[LAB_VARIABLE]
        student = SimpleNamespace(user=SimpleNamespace(name="ada"))
        root = config.Spawner.notebook_dir.format(username="ada")  # JupyterLab opens the lab's files
        assert (folder(student) if callable(folder) else folder) == root
    dockerfile = text_of(ROOT / "Dockerfile")
    for target, argument in re.findall(r"--target (\w+) --build-arg (\w+)=", page):
        assert re.search(rf"^FROM \S+ AS {target}\nARG {argument}$", dockerfile, re.MULTILINE)
    assert len(ways) == 2


def test_the_readme_shows_every_scene():
    readme = text_of(ROOT / "README.md")
    shown = re.findall(r"^### `(\w+)`$", readme, re.MULTILINE)
    assert sorted(shown) == sorted(NAMES)


def test_the_readme_s_python_gives_the_numbers_it_says():
    (block,) = re.findall(r"^```python\n(.*?)^```$", text_of(ROOT / "README.md"), re.MULTILINE | re.DOTALL)
    names: dict = {}
    exec(compile(block, "README.md", "exec"), names)
    assert names["run"].x.shape[1:] == (10, 3)
    said = re.findall(r"^(\w+\(.+\))  # ([\d.]+) \w+$", block, re.MULTILINE)
    assert len(said) == 2
    for call, number in said:
        digits = len(number.partition(".")[2])
        assert f"{eval(call, names):.{digits}f}" == number


@pytest.mark.parametrize("page", [*PAGES, ROOT / "CITATION.cff"], ids=lambda page: page.name)
def test_a_page_names_no_folder_of_one_machine_and_no_other_host(page):
    assert not OF_ONE_MACHINE.findall(text_of(page))
    assert set(HOST.findall(text_of(page))) <= ALLOWED_HOSTS


def test_the_table_of_integrators_is_what_they_declare():
    rows = re.findall(r"^\| `(\w+)` \| (\d)[^|]*\| (yes)? *\|", text_of(ROOT / "docs" / "measured.md"), re.MULTILINE)
    assert {name: (int(order), bool(symplectic)) for name, order, symplectic in rows} == {
        name: (record.order, record.symplectic) for name, record in INTEGRATORS.items()
    }


def test_every_integrator_has_its_physics():
    page = text_of(ROOT / "docs" / "physics.md")
    for name in INTEGRATORS:
        assert f"| `{name}` |" in page


def test_the_citation_is_valid():
    yaml = pytest.importorskip("yaml")
    cited = yaml.safe_load(text_of(ROOT / "CITATION.cff"))
    assert {"cff-version", "message", "title", "authors", "version", "license"} <= cited.keys()
    assert all("name" in author or "family-names" in author for author in cited["authors"])
    version = re.search(r'^version = "(.+)"$', text_of(ROOT / "pyproject.toml"), re.MULTILINE)
    assert str(cited["version"]) == version[1]


def test_the_changelog_begins_with_this_version():
    version = re.search(r'^version = "(.+)"$', text_of(ROOT / "pyproject.toml"), re.MULTILINE)
    headings = re.findall(r"^## \[(.+)\] - \d{4}-\d\d-\d\d$", text_of(ROOT / "CHANGELOG.md"), re.MULTILINE)
    assert headings[0] == version[1]
