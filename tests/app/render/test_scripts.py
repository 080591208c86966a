"""The JavaScript of the page: its modules, how they are written into a page, and their unit tests under Node."""

import json
import re
import shutil
import subprocess
from pathlib import Path
from urllib.parse import unquote

import pytest

from app.render import scripts
from app.render.scripts import BESIDE, IMPORTED, PAGE, REPLAY, SHARED, import_map, modules

ROOT = Path(__file__).parents[3]
BROWSERS = ("Chrome", "Edge", "Firefox", "Safari")
# Rooms from left to right: none imports a room to its left.
ORDER = ("beside", "page", "sharing", "panel", "scene", "sea", "shading", "core")


def imports_of(path: str) -> list[str]:
    """Paths of the modules that a module imports, those that it may import later too."""
    room = path.partition("/")[0]
    found = [target for _, target in IMPORTED.findall(modules()[path])]
    return [target.removeprefix("../") if target.startswith("../") else f"{room}{target[1:]}" for target in found]


def test_modules_import_what_is_there_in_one_direction() -> None:
    for path in modules():
        for target in imports_of(path):
            assert target in modules(), (path, target)
            if target != "shared.js":
                assert ORDER.index(path.partition("/")[0]) <= ORDER.index(target.partition("/")[0]), (path, target)


def test_no_module_imports_itself_by_way_of_others() -> None:
    open_: list[str] = []

    def visit(path: str) -> None:
        assert path not in open_, [*open_, path]
        open_.append(path)
        for target in imports_of(path):
            visit(target)
        open_.pop()

    for path in modules():
        visit(path)


def test_every_module_is_started_by_an_entry() -> None:
    reached = [PAGE, REPLAY, BESIDE]
    for path in reached:
        reached += [target for target in imports_of(path) if target not in reached]
    assert set(reached) == set(modules())


def test_types_are_declared_of_all_constants_that_python_shares() -> None:
    declared = (Path(scripts.__file__).parent / "js" / "shared.d.ts").read_text("utf-8")
    assert re.findall(r"const (\w+):", declared) == list(SHARED)


def test_the_page_the_linter_and_the_documentation_name_the_same_oldest_browsers() -> None:
    script = Path(scripts.__file__).parent / "js" / "before" / "failures.js"
    found = [
        {name: re.search(rf"{name}\D+(\d+(?:\.\d+)?)", line, re.IGNORECASE) for name in BROWSERS}
        for path, word in ((script, "OLDEST ="), (ROOT / ".ci/js/eslint.config.mjs", "browsers:"),
                           (ROOT / "docs/platforms.md", "The oldest browsers"))
        for line in path.read_text("utf-8").splitlines() if word in line
    ]  # fmt: skip
    versions = [{name: match and match[1] for name, match in one.items()} for one in found]
    assert versions == [versions[0]] * 3
    assert all(versions[0].values())


def test_an_import_map_holds_each_module_as_it_is_but_for_names() -> None:
    """Characters that an address or HTML takes for something else are written in another way."""
    sources = {
        "sea/a.js": 'import { b } from "./b.js";\nimport "./b.js";\n// 100 % #1 </script> ü\n',
        "sea/b.js": 'import("../core/c.js")',
    }
    text = import_map(sources)
    assert text.count("</script>") == 1
    found = json.loads(re.findall(r'<script type="importmap">(.*)</script>', text)[0])["imports"]
    assert list(found) == ["springtide/sea/a.js", "springtide/sea/b.js"]
    for path, name in zip(sources, found, strict=True):
        head, _, written = found[name].partition(",")
        assert head == "data:text/javascript;charset=utf-8"
        assert not set(written) & set("\n\t#<>")
        original = sources[path].replace('"./b.js"', '"springtide/sea/b.js"').replace("../core", "springtide/core")
        assert unquote(written) == f"{original}\n//# sourceURL={name}\n"


@pytest.mark.skipif(shutil.which("node") is None, reason="no node on the search path")
def test_pure_modules_do_what_their_tests_say(tmp_path: Path) -> None:
    """`node --test` on tests/js, beside the modules and the constants that they share with Python."""
    (tmp_path / "package.json").write_text('{"type": "module"}', "utf-8")
    for path, source in modules().items():
        file = tmp_path / "js" / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(source, "utf-8")
    shutil.copytree(ROOT / "app" / "render" / "js" / "before", tmp_path / "js" / "before")
    tests = sorted((ROOT / "tests" / "js").rglob("*.test.js"))
    for test in tests:
        shutil.copy(test, tmp_path)
    command = ["node", "--test", *(test.name for test in tests)]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, encoding="utf-8", timeout=120)
    assert tests
    assert done.returncode == 0, done.stdout + done.stderr
