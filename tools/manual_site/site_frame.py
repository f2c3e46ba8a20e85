"""What all pages of the manual have around them, the column that leads to them, and the index of the search."""
import html
import json
import os
import pathlib
import re
import shutil

HERE = pathlib.Path(__file__).resolve().parent
LUNR = pathlib.Path("/usr/share/javascript/lunr/lunr.js")
HEADING = re.compile(r'<h([1-4])[^>]*?(?: id="([^"]+)")?>(.*?)</h\1>', re.DOTALL)
MEMBER = re.compile(r'<a id="(\w+)" name="\w+"></a>\s*<h2 class="memtitle">(.*?)</h2>', re.DOTALL)
MOST_TEXT = 700  # characters of a section that are kept to be shown beside its name


def text_of(markup: str) -> str:
    """The words of HTML."""
    markup = re.sub(r"<(script|style|figcaption)\b.*?</\1>", " ", markup, flags=re.DOTALL)
    markup = re.sub(r"</?(p|div|li|td|th|tr|pre|h[1-6]|br|table|ul|ol)\b[^>]*>", " ", markup)
    return re.sub(r"\s+", " ", html.unescape(re.sub(r"<[^>]+>", "", markup))).strip()


class Site:
    """Pages are added with their place, relative to the folder; then finish() writes them and the index."""

    def __init__(self, out: pathlib.Path, groups: list[tuple[str, list[tuple[str, str]]]], folded: set[str]):
        """`groups`: headings of the column, each with titles and places; those in `folded` can be opened."""
        self.out, self.groups, self.folded = out, groups, folded
        self.sections: list[tuple[str, str, str, str]] = []  # address, title of the page, heading, text
        shutil.copyfile(HERE / "manual.css", out / "manual.css")
        shutil.copyfile(HERE / "search.js", out / "search.js")
        shutil.copyfile(LUNR, out / "lunr.js")

    def frame(self, place: str, title: str, home: str, kind: str = "") -> tuple[str, str]:
        """What stands before and behind the content of a page; `home` leads to the folder of the site ("../" or "")."""
        before = (f'<!doctype html>\n<html lang="en" data-home="{home}"><head><meta charset="utf-8">'
                  f'<meta name="viewport" content="width=device-width"><title>{title}</title>'
                  f'<link rel="stylesheet" href="{home}manual.css"></head>\n<body>\n'
                  f'<header><a class="home" href="{home}index.html">Segue</a> <a class="to_contents" href="#contents">Contents</a>'
                  '<form id="search" role="search" hidden><input type="search" placeholder="Search" '
                  'aria-label="Search the manual" autocomplete="off"><ol id="found" hidden></ol></form></header>\n'
                  f'<main class="{kind}">\n')
        behind = f'\n</main>\n{self.column(place, home)}<script src="{home}search.js"></script>\n</body></html>\n'
        return before, behind

    def column(self, here: str, home: str) -> str:
        text = '<nav id="contents" aria-label="Contents">\n'
        for name, pages in self.groups:
            items = "".join(f'<li><a href="{home}{place}"{" aria-current=page" if place == here else ""}>{html.escape(title)}</a></li>\n'
                            for title, place in pages)
            if name in self.folded:
                is_open = " open" if here in [place for _, place in pages] else ""
                text += f"<details{is_open}><summary>{name}</summary><ul>\n{items}</ul></details>\n"
            else:
                text += f"<h2>{name}</h2>\n<ol>\n{items}</ol>\n"
        return text + "</nav>\n"

    def add(self, place: pathlib.Path, body: str, title: str):
        home = os.path.relpath(".", place.parent) + "/"
        home = "" if home == "./" else home
        before, behind = self.frame(place.as_posix(), html.escape(title), home)
        (self.out / place).parent.mkdir(parents=True, exist_ok=True)
        (self.out / place).write_text(before + body + behind)
        self.index(place.as_posix(), title, body, HEADING)

    def index(self, place: str, title: str, body: str, heading: re.Pattern):
        """Takes the sections of a page into the index: from heading to heading, of HEADING or MEMBER."""
        marks = list(heading.finditer(body))
        first = text_of(body[: marks[0].start()] if marks else body)
        if first:
            self.sections.append((place, title, title, first))
        for at, mark in enumerate(marks):
            end = marks[at + 1].start() if at + 1 < len(marks) else len(body)
            anchor, name = (mark[2], mark[3]) if heading is HEADING else (mark[1], mark[2])
            address = f"{place}#{anchor}" if anchor else place
            self.sections.append((address, title, text_of(name).removeprefix("◆").strip(), text_of(body[mark.end() : end])))

    def finish(self):
        from lunr import lunr  # Debian's python3-lunr

        def words(text: str) -> str:
            return " ".join(re.findall(r"\w+", text.lower()))

        chapters = {place for name, pages in self.groups if name not in self.folded for _, place in pages}
        documents = []
        for number, (address, title, heading, text) in enumerate(self.sections):
            document = {"ref": str(number), "title": words(title), "heading": words(heading), "text": words(text)}
            documents.append((document, {"boost": 3 if address.split("#")[0] in chapters else 1}))
        fields = [{"field_name": "title", "boost": 5}, {"field_name": "heading", "boost": 10}, "text"]
        index = lunr(ref="ref", fields=fields, documents=documents).serialize()
        shown = [(*section[:3], section[3][:MOST_TEXT]) for section in self.sections]
        content = json.dumps({"index": index, "sections": shown}, ensure_ascii=False, separators=(",", ":"))
        (self.out / "search_index.js").write_text(f"const segueSearch = {content}\n")
