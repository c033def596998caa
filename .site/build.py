"""Build: the site, offline, from the repository, with one command.

    python -m pip install -r .site/environment.txt
    python .site/build.py                            into build/site; open build/site/index.html

In:  the lessons with their stored outputs, the docstrings, the teacher's pack, README.md and results.md.
Out: a folder of pages that needs no server and asks nobody: every link in it leads somewhere, or the build fails.
"""

import json
import re
import shutil
import subprocess
import sys
import time
import tomllib
from pathlib import Path
from tempfile import TemporaryDirectory

import links
import lite
import reference
from lessons import SLIDER, page_of

import primkit as pk
from primkit.course.leaks import find_leaks, secrets_of

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
MOST_BYTES = 1_000_000  # of a lesson's page
ON_FRONT = ("The course", "Does it hold?")  # of README.md; the rest is the page "Start"
MOVED = {".site/": "", "notebooks/teacher/": "teacher/", ".github/CHANGELOG": "changelog"}  # the links of README.md
WORDS = "**[Start here](start.md)**, [try it live](live.md), or read: the sliders and quizzes of these pages work."
TABLE = re.compile(r"(?:^\|.*\n)+", re.MULTILINE)
SIZE, PLOT = re.compile(r'width="\S+" height="\S+" viewBox="[^"]+"'), re.compile(r'viewBox="([^"]+)" overflow="hidden"')
STORY = re.compile(r"^!\[.*\]\(data/pictures/story\.png\)$", re.MULTILINE)
LINK = re.compile(r"(?<!!)\[([^\]]+)\]\((?!https?:)([^)#\s]*)(#[^)]*)?\)")
# Of the teacher's pack: what needs no solution to be read. The pages of the problem sets stay with their solutions.
PACK = ("README.md", "class.md", "running.md", "untrusted_code.md", "accessibility.md", "lessons/*.md")


def main():
    """Build the site and look at it."""
    out = Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "build" / "site")
    start = time.perf_counter()
    with TemporaryDirectory() as folder:
        stage(Path(folder))
        print(f"sources after {time.perf_counter() - start:.0f} s", flush=True)
        shutil.rmtree(out, ignore_errors=True)
        command = [sys.executable, "-m", "sphinx", "-q", "-b", "html", "-c", str(HERE), folder, str(out)]
        subprocess.run(command, check=True, cwd=ROOT)
    shutil.rmtree(out / ".doctrees", ignore_errors=True)
    faults = [*links.faults(out), *too_large(out), *leaks(out)]
    print(*faults, sep="\n", end="\n" * bool(faults))
    pages = len(list(out.rglob("*.html")))
    print(f"{pages} pages in {out}, {time.perf_counter() - start:.0f} s, {len(faults)} faults")
    sys.exit(bool(faults))


def stage(folder):
    """Write the sources of all pages into a folder."""
    shutil.copytree(ROOT / "data" / "pictures", folder / "data" / "pictures")
    texts = {
        "live.md": live((HERE / "live.md").read_text(encoding="utf-8")),
        "results.md": (HERE / "results.md").read_text(encoding="utf-8"),
        "changelog.md": (ROOT / ".github" / "CHANGELOG.md").read_text(encoding="utf-8"),
        **dict(front((ROOT / "README.md").read_text(encoding="utf-8"), lessons_into(folder / "lessons"))),
        **{f"api/{name}.rst": text for name, text in reference.pages().items()},
        **dict(pack(ROOT / "notebooks" / "teacher")),
    }
    for name, text in texts.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    for page in folder.rglob("*.md"):  # now that all are there
        page.write_text(kept_links(page), encoding="utf-8")


def lessons_into(folder):
    """Write the lessons' pages, and their list; return the door to each: its slider's picture, and its title."""
    folder.mkdir()
    titles = {}
    for path in sorted((ROOT / "notebooks").glob("[0-9]*.ipynb")):
        lesson = json.loads(path.read_text(encoding="utf-8"))
        sources = ["".join(cell["source"]) for cell in lesson["cells"]]
        titles[path.stem] = f"{path.stem[:2]} {sources[0].partition(chr(10))[0].removeprefix('# ')}"
        drawn = getattr(pk.widgets, SLIDER.search("\n".join(sources))[1])().draw()
        plot = f'viewBox="{PLOT.search(drawn)[1]}"'  # alone: the words around it are too small to be read on a door
        (folder / f"{path.stem}.svg").write_text(SIZE.sub(plot, drawn, count=1), encoding="utf-8")
        (folder / path.name).write_text(json.dumps(page_of(lesson)), encoding="utf-8")
    below = [f"{title} <{name}>" for name, title in titles.items()]
    doors = "\n".join(f"* [![](lessons/{name}.svg) {title}](lessons/{name}.ipynb)" for name, title in titles.items())
    (folder / "index.md").write_text(f"# Lessons\n\n{doors.replace('lessons/', '')}\n\n{tree(below)}", encoding="utf-8")
    return doors


def front(readme, doors):
    """Yield the front page and the page behind it, from README.md: the course's table becomes doors with pictures."""
    for there, here in MOVED.items():
        readme = readme.replace(f"]({there}", f"]({here}")
    intro, *sections = re.sub(r"<!--.*?-->\n*", "", readme, flags=re.DOTALL).split("\n## ")
    first = [section for section in sections if section.startswith(ON_FRONT)]
    shown = "\n## ".join([f"{intro}\n{WORDS}\n\n{STORY.search(readme)[0]}\n", *first])
    chapters = "start", "lessons/index", "live", "Results <results>", "api/index", "Teachers <teacher/README>"
    yield "index.md", TABLE.sub(lambda _: doors + "\n", shown, count=1) + tree((*chapters, "Changes <changelog>"))
    yield "start.md", "# " + "\n## ".join(section for section in sections if section not in first)


def live(text):
    """Return the page of all doors to a running lesson; those at other people's need an owner's address."""
    told = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    owner = told["tool"]["hatch"]["metadata"]["hooks"]["custom"]["owner"]
    doors = {
        "lite": f"https://{owner}.github.io/primkit/lite/lab/index.html?path=00_start_here.ipynb",
        "colab": f"https://colab.research.google.com/github/{owner}/primkit/blob/main/notebooks/00_start_here.ipynb",
        "binder": f"https://mybinder.org/v2/gh/{owner}/primkit/main?labpath=notebooks/00_start_here.ipynb",
    }
    waiting = "waits for the project's owner" if owner.isupper() else ""
    words = {name: waiting or f"[open lesson 00]({door})" for name, door in doors.items()}
    return text.format(**words, first=lite.FIRST)


def tree(pages):
    """Return the directive that puts pages below this one."""
    return "```{toctree}\n:hidden:\n\n" + "\n".join(pages) + "\n```\n"


def pack(folder):
    """Yield the teacher's pages, without those of the problem sets."""
    files = [file for pattern in PACK for file in sorted(folder.glob(pattern))]
    names = [file.relative_to(folder).with_suffix("").as_posix() for file in files]
    for file, name in zip(files, names, strict=True):
        up = "../" * (name.count("/") + 1)
        text = re.sub(rf"\]\({up}(?=\d)", f"]({up}lessons/", file.read_text(encoding="utf-8"))
        yield f"teacher/{name}.md", text + f"\n{tree(names[1:])}" * (name == "README")


def kept_links(page):
    """Return a page's text with links to what is on the site; of others the words stay."""

    def keep(match):
        words, target, _ = match.groups()
        return match[0] if not target or (page.parent / target).is_file() else words

    return LINK.sub(keep, page.read_text(encoding="utf-8"))


def leaks(out):
    """Return what of the solutions stands on the site."""
    return map(str, find_leaks([out], secrets_of(ROOT / "notebooks" / "assignments")))


def too_large(out):
    """Return the lessons whose page is too large to be read on a telephone."""
    for page in sorted((out / "lessons").glob("*.html")):
        if page.stat().st_size > MOST_BYTES:
            yield f"{page.name}: {page.stat().st_size:,} bytes, at most {MOST_BYTES:,}"


if __name__ == "__main__":
    main()
