"""Check the links of a built site: `python docs/check_links.py build/site`.

Each link of a page to a file of the site, and to a place on a page, must lead somewhere. Links to
other sites are not followed. Dead links are printed, and the exit code is 1.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass, field
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit


@dataclass
class Page(HTMLParser):
    """The links of a page, and the places on it that a link can name."""

    links: set[str] = field(default_factory=set)
    places: set[str] = field(default_factory=lambda: {""})

    def __post_init__(self) -> None:
        super().__init__()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for name, value in attrs:
            if name in ("href", "src") and value:
                self.links.add(value)
            elif name in ("id", "name") and value and tag != "meta":
                self.places.add(value)


def read_pages(site: Path) -> dict[Path, Page]:
    """Read all pages of a site, without what its theme brings along."""
    pages = {}
    for path in sorted(set(site.rglob("*.html")) - set(site.rglob("_static/*"))):
        page = Page()
        page.feed(path.read_text(encoding="utf-8"))
        pages[path.resolve()] = page
    return pages


def find_dead_links(site: Path) -> tuple[list[str], int]:
    """Return each dead link as "page: link", and the number of links that were followed."""
    pages = read_pages(site)
    dead, followed = [], 0
    for path, page in pages.items():
        for link in sorted(page.links):
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            followed += 1
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if not target.is_file() or (
                target in pages and unquote(parts.fragment) not in pages[target].places
            ):
                dead.append(f"{path.relative_to(site.resolve())}: {link}")
    return dead, followed


def main(site: Path) -> int:
    dead, followed = find_dead_links(site)
    print(*dead, f"{followed} links inside the site, {len(dead)} dead", sep="\n")
    return 1 if dead else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
