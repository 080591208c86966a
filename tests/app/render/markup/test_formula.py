"""Formulas as MathML."""

import pytest

from app.render.markup.formula import FONTS, formula

BAR = '<mo stretchy="false" lspace="0" rspace="0">|</mo>'


@pytest.mark.parametrize(
    ("text", "html"),
    [
        ("F = m a", "<mi>F</mi><mo>=</mo><mi>m</mi><mi>a</mi>"),
        ("ρ_oil^2", "<msubsup><mi>ρ</mi><mi>oil</mi><mn>2</mn></msubsup>"),
        ("x^{−2 k}", "<msup><mi>x</mi><mrow><mo>−</mo><mn>2</mn><mi>k</mi></mrow></msup>"),
        ("a_0 - 1.5", "<msub><mi>a</mi><mn>0</mn></msub><mo>−</mo><mn>1.5</mn>"),
        (r"\frac{a}{b}", "<mfrac><mrow><mi>a</mi></mrow><mrow><mi>b</mi></mrow></mfrac>"),
        (r"\sqrt{a}", "<msqrt><mrow><mi>a</mi></mrow></msqrt>"),
        ('"a < b"', "<mtext>\u00a0a &lt; b\u00a0</mtext>"),
        ("|a|", f"{BAR}<mi>a</mi>{BAR}"),
        ("ln a", '<mi>ln</mi><mspace width="0.17em"></mspace><mi>a</mi>'),
        ("max|a|", f"<mi>max</mi>{BAR}<mi>a</mi>{BAR}"),
        ("<b>", "<mo>&lt;</mo><mi>b</mi><mo>&gt;</mo>"),
    ],
)
def test_formulas_become_mathml(text: str, html: str) -> None:
    fonts = ", ".join(FONTS)
    assert formula(text) == f'<math display="block" style="font-family: {fonts}, math"><mrow>{html}</mrow></math>'


@pytest.mark.parametrize("text", ["{a", "a}", r"\frac{a}", "a^", r"\sum", "a_{b"])
def test_what_is_no_formula_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r"braces|missing|not known"):
        formula(text)
