"""The HTML of panel and reports."""

from app.render.markup.html import Html, bold, escape, fill, join, lines, note, table

EVIL = "<img src=x onerror='alert(1)'> & more"
SAFE = "&lt;img src=x onerror=&#39;alert(1)&#39;&gt; &amp; more"


def test_text_is_escaped_and_html_is_not() -> None:
    assert escape(EVIL) == SAFE
    assert escape(Html("<b>x</b>")) == "<b>x</b>"
    assert fill("<p>{} {name}</p>", EVIL, name=bold(EVIL)) == f"<p>{SAFE} <b>{SAFE}</b></p>"
    assert "<img" not in note(EVIL)
    assert SAFE in note(EVIL)
    for text in (bold(EVIL), join((EVIL, "x")), lines((EVIL,)), table((EVIL,), ((EVIL, "1"),))):
        assert isinstance(text, Html)
        assert "<img" not in text
        assert SAFE in text


def test_what_is_escaped_once_is_not_escaped_again() -> None:
    assert note(lines((bold("a < b"),))).count("&lt;") == 1
    assert "&amp;" not in note(table((("<", "<"),), (("<",),)))


def test_what_goes_to_viser_is_a_plain_string() -> None:
    assert type(note(bold("x"))) is str
    assert type(str(bold("x"))) is str


def test_fields_of_a_template_take_formats() -> None:
    assert fill("{:.2f} {x.real:g}", 1.0 / 3.0, x=2.5) == "0.33 2.5"
    assert fill("{{}} {}", 1) == "{} 1"
    assert fill("{0}{1:>3}{0}{{{x}}}", "a", 7, x="<") == "a  7a{&lt;}"
    assert fill("{:.1f} {}", 0.25, "x") == fill("{:.1f} {}", 0.25, "x") == "0.2 x"  # read once, filled twice


def test_a_table_has_a_cell_for_each_entry() -> None:
    found = table((("", ""), ("a", "m"), ("b", "s")), (("x", 1, 2), ("y", 3, 4)))
    assert (found.count("<tr>"), found.count("<th>"), found.count("<td>")) == (3, 3, 6)
    assert "<th>a<br>m</th>" in found
    assert found.index("<thead>") < found.index("</thead>") < found.index("<tbody>")
