"""The reference of the C++ interface: pages of the installed headers, made by Doxygen."""
import importlib.machinery
import importlib.util
import pathlib
import re
import subprocess
import tempfile

from site_frame import MEMBER, Site

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
FOLDER = "reference"
# What Doxygen 1.9 does not understand of correct code: specialisations in namespace std, a class that is nested and defined later.
MISUNDERSTOOD = re.compile(r"scope for class std::hash|Compound std::hash|task_network::Order::after")
MACROS = ["GUARDED_BY(x)", "REQUIRES(x)", "EXCLUDES(x)", "ACQUIRE(x)", "RELEASE(x)", "CAPABILITY(x)"]
SETTINGS = """
PROJECT_NAME = Segue
INPUT = {inputs}
OUTPUT_DIRECTORY = {work}
HTML_OUTPUT = html
HTML_HEADER = {work}/header.html
HTML_FOOTER = {work}/footer.html
USE_MDFILE_AS_MAINPAGE = {work}/reference.md
STRIP_FROM_PATH = {root}
STRIP_FROM_INC_PATH = {root}
PREDEFINED = {macros}
INPUT_FILTER = "sed '1s,^// SPDX.*,/** @file */,'"
WARN_LOGFILE = {work}/warnings
EXCLUDE_SYMBOLS = detail *::detail *::detail::* std
JAVADOC_AUTOBRIEF = YES
HIDE_UNDOC_CLASSES = NO
EXTRACT_PRIV_VIRTUAL = YES
HIDE_UNDOC_MEMBERS = NO
WARN_IF_UNDOCUMENTED = YES
MACRO_EXPANSION = YES
EXPAND_ONLY_PREDEF = YES
SEARCH_INCLUDES = NO
GENERATE_LATEX = NO
SEARCHENGINE = NO
DISABLE_INDEX = YES
HAVE_DOT = NO
CLASS_GRAPH = NO
INHERIT_DOCS = YES
INLINE_INHERITED_MEMB = NO
HTML_DYNAMIC_MENUS = NO
SHOW_USED_FILES = NO
SHOW_INCLUDE_FILES = YES
VERBATIM_HEADERS = NO
GENERATE_TODOLIST = NO
GENERATE_TESTLIST = NO
GENERATE_BUGLIST = NO
TOC_INCLUDE_HEADINGS = 0
QUIET = YES
"""


def installed_headers() -> list[str]:
    """As others include them: those that tools/check_house knows."""
    loader = importlib.machinery.SourceFileLoader("check_house", str(ROOT / "tools/check_house"))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("check_house", loader))
    loader.exec_module(module)
    return sorted(name for name, _, _ in module.installed_headers())


def main_page(headers: list[str]) -> str:
    """The first page: the folders with their jobs, of DESIGN.md, and their headers."""
    house = (ROOT / "DESIGN.md").read_text().split("## The house")[1].split("\n## ")[0]
    jobs = dict(re.findall(r"^\| (\w+) \| ([^|]+) \| [^|]*\|$", house, re.MULTILINE))
    text = ("# C++ reference\n\nThe headers that are installed, by folder; each folder is a library `segue::FOLDER` "
            "of the CMake package. All [classes](annotated.html), all [namespaces](namespaces.html).\n\n"
            "| folder | job | headers |\n| --- | --- | --- |\n")
    for folder in dict.fromkeys(name.split("/")[1] for name in headers):
        links = ", ".join(f"[{pathlib.PurePath(name).name}](@ref {name})" for name in headers if name.split("/")[1] == folder)
        text += f"| {folder} | {jobs.get(folder, '').strip()} | {links} |\n"
    return text


def problems_in(warnings: str) -> list[str]:
    """Wrong comments, and classes without one."""
    lines = [line.replace(f"{ROOT}/", "") for line in warnings.splitlines() if " warning: " in line and not MISUNDERSTOOD.search(line)]
    return [line for line in lines if "Compound " in line or "is not documented" not in line]


def add_reference(site: Site) -> tuple[int, list[str]]:
    """Makes the pages and takes them into the search; how many headers they are of, and what is wrong with comments."""
    headers = installed_headers()
    with tempfile.TemporaryDirectory(prefix="segue-reference-") as name:
        work = pathlib.Path(name)
        before, behind = site.frame(f"{FOLDER}/index.html", "$title", "$relpath^../", "reference")
        (work / "header.html").write_text(before.replace("</head>", '<script src="$relpath^jquery.js"></script>'
                                                         '<script src="$relpath^dynsections.js"></script></head>') + "<div>\n")
        (work / "footer.html").write_text(behind)
        (work / "reference.md").write_text(main_page(headers))
        inputs = " ".join([f"{work}/reference.md", *(str(ROOT / header) for header in headers)])
        settings = SETTINGS.format(inputs=inputs, work=work, root=ROOT, macros=" ".join(f"SEGUE_{macro}=" for macro in MACROS))
        (work / "Doxyfile").write_text(settings)
        subprocess.run(["doxygen", "Doxyfile"], cwd=work, check=True)
        problems = problems_in((work / "warnings").read_text())
        (work / "html").rename(work / FOLDER)
        (site.out / FOLDER).mkdir()
        made = {file.name for file in (work / FOLDER).iterdir()}
        for file in sorted((work / FOLDER).iterdir()):
            if file.suffix == ".html":
                (site.out / FOLDER / file.name).write_text(without_dead_links(file.read_text(), made))
            elif file.suffix in (".js", ".svg", ".png"):
                (site.out / FOLDER / file.name).write_bytes(file.read_bytes())
    for page in sorted((site.out / FOLDER).glob("*.html")):
        index_page(site, page)
    return len(headers), problems


def without_dead_links(text: str, made: set[str]) -> str:
    """Doxygen links to lists of nested classes that are all private, and to pages of concepts that it does not make."""
    anchors = set(re.findall(r'(?:id|name)="([^"]+)"', text))

    def kept(link: re.Match) -> str:
        file, _, anchor = link[1].partition("#")
        is_dead = anchor not in anchors if file == "" else ":" not in file and "/" not in file and file not in made
        return link[2] if is_dead else link[0]

    return re.sub(r'<a (?:class="[^"]*" )?href="([^"]+)"(?: target="_self")?>([^<]*)</a>', kept, text)


def index_page(site: Site, page: pathlib.Path):
    """Pages of classes, namespaces and headers; the lists of all of them have nothing of their own."""
    text = page.read_text()
    title = re.search(r"<title>(.*?)</title>", text)[1]
    if not re.match(r"(class|struct|union|namespace)segue|\w+_8hpp", page.name) or page.name.endswith("-members.html"):
        return
    body = text[text.index("<main") : text.index("</main>")]
    site.index(f"{FOLDER}/{page.name}", re.sub(r"&lt;.*", "", title).strip(), body, MEMBER)
