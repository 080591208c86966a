"""viser's page with ours around it, for a lab and for a replay.

The cover is at the top of the body, so that it is seen before the client behind it is read; our modules follow
(`app/render/scripts.py`).
"""

import re
from collections.abc import Iterable
from importlib import resources

from app.render.markup.html import Html, fill
from app.render.scripts import before_tags, tags

COVER_STYLE = "cover.css"


def style_sheet(name: str) -> Html:
    """A style sheet in `js`, without its comments, which would come before the cover."""
    source = (resources.files("app.render") / "js" / name).read_text("utf-8")
    return Html(re.sub(r"/\*.*?\*/\s*", "", source, flags=re.DOTALL))


def cover(words: str) -> Html:
    """The cover, with the words of its beginning."""
    return fill('<div id="springtide-cover"><h1>Springtide</h1><div id="springtide-cover-words">{}</div></div>', words)


def with_ours(
    page: str, *, title: str, words: str, styles: Iterable[str] = (), before: Iterable[str], entry: str, last: str = ""
) -> str | None:
    """viser's page with ours around it; None if it is not as expected.

    words: on the cover. styles: style sheets after that of the cover. before: scripts that run before the client.
    entry: the module that starts the others. last: HTML for the end of the page.
    """
    head, body_tag, body = page.rpartition("<body>")
    # viser's client is one long script in the head, as is the recording of a replay. Below the cover they do not
    # delay it.
    start, end = head.find("<script"), head.rfind("</script>")
    if not body_tag or not 0 <= start < end or "</body>" not in body:
        return None
    end += len("</script>")
    client = head[start:end]
    sheets = f"<style>{''.join(map(style_sheet, (COVER_STYLE, *styles)))}</style>"
    head = head[:start].replace("<title>Viser</title>", fill("<title>{}</title>", title), 1) + sheets + head[end:]
    body = body.replace("</body>", f"{client}{tags(entry)}{last}</body>", 1)
    return f"{head}<body>{cover(words)}{before_tags(before)}{body}"
