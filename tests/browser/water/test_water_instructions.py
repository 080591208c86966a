"""Static instructions of the water's fragment shader, as glslang and spirv-opt leave them."""

import re
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from app.server.viewer import Viewer

TOOLS = ("glslangValidator", "spirv-opt", "spirv-dis")
LIMIT, FULLEST = 2690, 3300  # at full detail, and the same with oil and hulls; the figures are in docs/measured.md
SOURCES = """window.sources = []; const put = WebGL2RenderingContext.prototype.shaderSource;
WebGL2RenderingContext.prototype.shaderSource = function (shader, source) {
    const fragment = this.getShaderParameter(shader, this.SHADER_TYPE) === this.FRAGMENT_SHADER;
    const wanted = ["shadeSea(", "seaPlaces", "#define USE_ENVMAP"]; // until its sky is there it is shorter
    if (fragment && wanted.every((word) => source.includes(word))) window.sources.push(source);
    const flat = "#version 300 es\\nout lowp vec4 color; void main() { color = vec4(1.0); }";
    put.call(this, shader, fragment ? flat : source);
};"""
# Words that GLSL for SPIR-V reserves, and types that it does not allow.
ALLOWED = [
    (r"#version 300 es", "#version 320 es"),
    (r"\baverage\b", "average_"),
    (r"uniform bool isOrthographic", "uniform int isOrthographic"),
]
NO_INSTRUCTION = re.compile(r"Op(Label|Function|FunctionEnd|SelectionMerge|LoopMerge|Name|Variable|Line)\b")


@pytest.fixture
def source(chromium: Any) -> Iterator[str]:
    """The water's shader at full detail, with all that three inserts."""
    lab = Viewer("127.0.0.1", 0)
    lab.open("square_sea")
    page = chromium.new_page(viewport={"width": 300, "height": 200})
    page.add_init_script(SOURCES)
    page.goto(f"http://127.0.0.1:{lab.port}/?hideViserLogo&fixedDpr=0.2")
    page.wait_for_function("window.sources.length", timeout=120_000)
    yield page.evaluate("window.sources[0]")
    page.close()
    lab.shut()


def instructions(source: str, folder: Path) -> int:
    """The number of a shader's instructions."""
    for word, other in ALLOWED:
        source = re.sub(word, other, source)
    shader, code, best = (folder / f"water.{kind}" for kind in ("frag", "spv", "best.spv"))
    shader.write_text(source, "utf-8")
    for command in (
        ["glslangValidator", "-G", "--aml", "--amb", "-o", code, shader],
        ["spirv-opt", "-O", code, "-o", best],
    ):
        subprocess.run(command, check=True, capture_output=True)
    text = subprocess.run(["spirv-dis", "--no-header", best], check=True, capture_output=True, encoding="utf-8").stdout
    functions = text[text.index("OpFunction") :]
    return sum(not NO_INSTRUCTION.search(line) for line in functions.splitlines())


@pytest.mark.stress  # of interest where the shader is changed
@pytest.mark.skipif(any(shutil.which(tool) is None for tool in TOOLS), reason="no glslang or no SPIR-V tools")
def test_the_shader_of_the_water_has_few_instructions(source: str, tmp_path: Path) -> None:
    levels = [source.replace("#define DETAILS 2", f"#define DETAILS {details}") for details in (2, 1, 0)]
    counts = [instructions(level, tmp_path) for level in levels]
    fullest = instructions(
        source.replace("#define DETAILS 2", "#define DETAILS 2\n#define OIL\n#define HULLS"), tmp_path
    )
    print(f"instructions at full, less and least detail: {counts}; with oil and hulls: {fullest}")
    assert LIMIT >= counts[0] > counts[1] > counts[2] > 0
    assert FULLEST >= fullest > counts[0]
