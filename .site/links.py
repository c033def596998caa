"""Links: whether all that a page names lies in the folder, and nothing is loaded from elsewhere.

In:  a folder of pages.
Out: a sentence for each fault.
"""

import re
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

LOADED = {"img": "src", "script": "src", "link": "href", "source": "src", "iframe": "src"}
ELSEWHERE = re.compile(r"url\(\s*[\"']?https?:|@import\s+[\"']https?:")


class Page(HTMLParser):
    """The links, the names and the loaded things of a page."""

    def __init__(self, path):
        super().__init__()
        self.links, self.names, self.loaded = set(), set(), set()
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        """Gather."""
        told = dict(attributes)
        self.names |= {told[key] for key in ("id", "name") if told.get(key)}
        if tag == "a" and told.get("href"):
            self.links.add(told["href"])
        if told.get(LOADED.get(tag)) and told.get("rel") not in ("canonical", "next", "prev", "search", "index"):
            self.loaded.add(told[LOADED[tag]])

    handle_startendtag = handle_starttag


def faults(folder):
    """Yield a sentence for each link that leads nowhere, and each thing that is loaded from elsewhere."""
    pages = {path.resolve(): Page(path) for path in sorted(Path(folder).rglob("*.html")) if "_static" not in path.parts}
    for path, page in pages.items():
        name = path.relative_to(Path(folder).resolve())
        for link in sorted(page.links | page.loaded):
            parts = urlsplit(link)
            if parts.scheme == "data":
                continue
            if parts.scheme or parts.netloc:
                if link in page.loaded:
                    yield f"{name}: loads {link}"
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if not target.exists():
                yield f"{name}: {link} leads nowhere"
            elif parts.fragment and target in pages and unquote(parts.fragment) not in pages[target].names:
                yield f"{name}: {link} names nothing there"
    for sheet in sorted(Path(folder).rglob("*.css")):
        if ELSEWHERE.search(sheet.read_text(encoding="utf-8")):
            yield f"{sheet.relative_to(folder)}: loads from elsewhere"
