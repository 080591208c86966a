"""Runs functions of the water's shader on a table of inputs, in a program of their own, and reads the numbers back."""

import base64
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.render.scripts import import_map, modules

# A picture of float numbers, a point for each input. What three would insert is left out: no function here uses it.
# Numbers travel as the bytes of single-precision numbers in base 64: a list of them takes seconds.
RUN = """async ([expression, table, uniforms, tileSide, tile, details, functions]) => {
    const decode = (text) => new Float32Array(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
    const points = decode(table);
    const { WATER_GLSL: GLSL } = await import("springtide/sea/water_shader.js");
    const gl = document.createElement("canvas").getContext("webgl2");
    if (!gl.getExtension("EXT_color_buffer_float")) throw new Error("no float targets");
    const make = (kind, source) => {
        const made = gl.createShader(kind);
        gl.shaderSource(made, source), gl.compileShader(made);
        if (!gl.getShaderParameter(made, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(made));
        return made;
    };
    const names = ["noise", "waves", "sky", "surface", "dome"];
    const chunks = names.map((name) => GLSL[name]).join("\\n").replace(/#include <.*>/g, "");
    const program = gl.createProgram();
    gl.attachShader(program, make(gl.VERTEX_SHADER, `#version 300 es
        void main() { gl_Position = vec4(4 * (gl_VertexID % 2) - 1, 2 * (gl_VertexID / 2 * 2) - 1, 0, 1); }`));
    gl.attachShader(program, make(gl.FRAGMENT_SHADER, `#version 300 es
        precision highp float;
        #define MAX_WATERLINES 13
        #define DETAILS ${details}
        uniform vec3 eye;
        uniform mat4 toSea;
        uniform highp sampler2D inputs;
        out vec4 result;
        ${chunks}
        ${functions}
        void main() {
            vec4 p = texelFetch(inputs, ivec2(gl_FragCoord.xy), 0);
            result = ${expression};
        }`));
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    gl.useProgram(program);
    const texture = (unit, width, height, numbers, format, levels) => {
        gl.activeTexture(gl.TEXTURE0 + unit);
        gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
        gl.texImage2D(gl.TEXTURE_2D, 0, format, width, height, 0, gl.RGBA, gl.FLOAT, numbers);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, levels ? gl.LINEAR_MIPMAP_LINEAR : gl.NEAREST);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, levels ? gl.LINEAR : gl.NEAREST);
        if (levels) gl.generateMipmap(gl.TEXTURE_2D);
    };
    const width = 256, height = Math.ceil(points.length / 4 / width), numbers = new Float32Array(4 * width * height);
    numbers.set(points);
    texture(0, width, height, numbers, gl.RGBA32F, false);
    gl.uniform1i(gl.getUniformLocation(program, "inputs"), 0);
    if (tileSide) texture(1, tileSide, tileSide, decode(tile), gl.RGBA16F, true);
    for (const name of ["waveSlopes", "wavePlaces"]) gl.uniform1i(gl.getUniformLocation(program, name), 1);
    for (const [name, value] of Object.entries(uniforms)) {
        gl[`uniform${value.length}fv`](gl.getUniformLocation(program, name), value);
    }
    const target = gl.createTexture();
    gl.activeTexture(gl.TEXTURE2);
    gl.bindTexture(gl.TEXTURE_2D, target);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA32F, width, height);
    gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, target, 0);
    gl.viewport(0, 0, width, height);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    const found = new Float32Array(4 * width * height);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.FLOAT, found);
    gl.getExtension("WEBGL_lose_context")?.loseContext();
    const bytes = new Uint8Array(found.buffer, 0, 4 * points.length);
    let text = "";
    for (let at = 0; at < bytes.length; at += 4096) text += String.fromCharCode(...bytes.subarray(at, at + 4096));
    return btoa(text);
}"""


def page_with_modules(chromium: Any) -> Any:
    """An empty page that can import the modules of the lab."""
    page = chromium.new_page()
    page.set_content(f"<!doctype html>{import_map(modules())}")
    return page


def evaluate(
    page: Any,
    expression: str,
    points: NDArray[np.float64],
    uniforms: dict[str, Any] | None = None,
    tile: NDArray[np.float64] | None = None,
    details: int = 2,
    functions: str = "",
) -> NDArray[np.float64]:
    """A GLSL expression, a vec4, at each of (n, up to 4) points, in it "p": (n, 4).

    uniforms: vectors by name; the others are 0. tile: (m, m, 4), of both textures of the waves. details:
    of the shader. functions: GLSL that the expression needs beside the shader of water.
    """
    inputs = np.zeros((len(points), 4))
    inputs[:, : points.shape[1]] = points
    values = {name: [float(v) for v in value] for name, value in (uniforms or {}).items()}
    side, texels = (0, "") if tile is None else (len(tile), in_base_64(tile))
    given = [expression, in_base_64(inputs), values, side, texels, details, functions]
    found = page.evaluate(RUN, given)
    return np.frombuffer(base64.b64decode(found), np.float32).astype(float).reshape(-1, 4)


def in_base_64(numbers: NDArray[np.float64]) -> str:
    """The bytes of these numbers in single precision."""
    return base64.b64encode(numbers.astype(np.float32).tobytes()).decode()
