"""The page on contributing: each example is complete, and tests/repository/test_extension.py adds and runs it."""

import re

import pytest

from tests.docs.pages import ROOT, text_of
from tests.examples import PAGE, commands, section

HEADINGS = re.findall(r"^## (Add .+)$", text_of(PAGE), re.MULTILINE)


def test_there_is_an_example_of_each_thing_to_add():
    assert HEADINGS == [
        "Add an integrator", "Add a law of a link", "Add a force", "Add a spectrum", "Add a parameter",
        "Add a body shape", "Add a task", "Add a scene",
    ]  # fmt: skip


@pytest.mark.parametrize("heading", HEADINGS)
def test_each_example_is_run_by_a_test(heading):
    assert f'("{heading}"' in text_of(ROOT / "tests/repository/test_extension.py")


@pytest.mark.parametrize("heading", HEADINGS)
def test_an_example_names_the_files_of_its_blocks_and_ends_with_commands(heading):
    blocks = section(heading)
    assert all(block.path for block in blocks if block.language in ("python", "diff", "toml"))
    assert {block.language for block in blocks} <= {"python", "diff", "toml", "sh"}
    assert commands(blocks)


@pytest.mark.parametrize("heading", HEADINGS)
def test_an_example_is_python(heading):
    for block in section(heading):
        if block.language == "python":
            compile(block.text, block.path, "exec")
