"""The frame: environment.txt, pyproject.toml, CITATION.cff and the commands in README.md say the same."""

import importlib.util
import re
import tomllib
from pathlib import Path, PurePosixPath
from types import ModuleType

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from packaging.version import Version

ROOT = Path(__file__).resolve().parent.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


CLASSROOM = ROOT / "environment.txt"
TOLD = ("primkit", "notebooks", ".ci", ".github", ".site", "data")  # what readers of the project see, beside the top
TEACHERS = ROOT / "notebooks" / "teacher" / "environment.txt"  # and the tests'


def lines_of(file: Path) -> list[str]:
    lines = file.read_text(encoding="utf-8").splitlines()
    return [line for line in (re.sub(r"(^|\s)#.*", "", line).strip() for line in lines) if line]


def environment() -> list[str]:
    """Return the lines of both: the teacher's has the classroom's in it."""
    first, *more = lines_of(TEACHERS)
    assert (TEACHERS.parent / first.removeprefix("-r ")).resolve() == CLASSROOM
    return [*lines_of(CLASSROOM), *more]


def test_a_student_s_lab_shows_no_teacher_s_panels() -> None:
    """nbgrader puts its menu, Validate and Create Assignment into every Lab that it is installed beside."""
    assert not any(line.startswith("nbgrader") for line in lines_of(CLASSROOM))
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    start = readme[readme.index("<!-- ci: map -->") :].split("```")[1]
    assert "-r environment.txt" in start


def pins() -> dict[str, str]:
    exact = (Requirement(line) for line in environment() if line != "-e .")
    return {canonicalize_name(pin.name): str(pin.specifier).removeprefix("==") for pin in exact}


def test_environment_installs_primkit_itself() -> None:
    assert environment().count("-e .") == 1


@pytest.mark.parametrize("line", [line for line in environment() if line != "-e ."])
def test_environment_pins_exactly(line: str) -> None:
    assert re.fullmatch(r"[\w.-]+(\[[\w,]+\])?==\d+(\.\d+)*", line)


@pytest.mark.parametrize("needed", PROJECT["dependencies"] + PROJECT["optional-dependencies"]["test"])
def test_environment_pins_what_the_project_needs(needed: str) -> None:
    requirement = Requirement(needed)
    assert requirement.specifier.contains(pins()[canonicalize_name(requirement.name)])


def test_the_lowest_versions_are_those_that_are_stated() -> None:
    lines = (ROOT / "tests" / "lowest.txt").read_text(encoding="utf-8").splitlines()
    tested = dict(line.split("==") for line in lines if line and not line.startswith("#"))
    for requirement in map(Requirement, PROJECT["dependencies"]):
        (floor,) = requirement.specifier
        assert (floor.operator, Version(floor.version)) == (">=", Version(tested[requirement.name]))


def test_citation_has_the_project_s_version_and_licence() -> None:
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8").splitlines()
    assert f"version: {PROJECT['version']}" in citation
    assert [f"  - {name}" for name in PROJECT["license"].split(" AND ")] == [c for c in citation if c[:4] == "  - "][:2]
    (date,) = [line.removeprefix("date-released: ") for line in citation if line.startswith("date-released")]
    assert f"## {PROJECT['version']} ({date})" in (ROOT / ".github" / "CHANGELOG.md").read_text(encoding="utf-8")


def test_one_line_waits_for_an_owner() -> None:
    """Whoever owns the project writes a name once; no other file needs it, nor an address made from it."""
    files = [*ROOT.glob("*.*"), *(path for top in TOLD for path in (ROOT / top).rglob("*.*") if path.is_file())]
    texts = {path.relative_to(ROOT).as_posix(): path.read_text("utf-8", "replace") for path in files if path.is_file()}
    waiting = [
        (name, line) for name, text in texts.items() for line in text.splitlines() if re.search(r"\bOWNER\b", line)
    ]
    assert waiting == [("pyproject.toml", 'owner = "OWNER"')]
    own = r"github(?:usercontent)?\.(?:com|io)/[\w.-]+/primkit"
    assert [name for name, text in texts.items() if re.search(own, text)] == []


def test_library_has_the_project_s_version() -> None:
    contents = (ROOT / "primkit" / "__init__.py").read_text(encoding="utf-8").splitlines()
    assert f'__version__ = "{PROJECT["version"]}"' in contents


def test_a_wheel_has_the_table_of_contents_and_the_scene_s_front_end() -> None:
    """What the modules read is installed with them: hatch takes all in the folder that git does not ignore."""
    tool = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]
    wheel = tool["hatch"]["build"]["targets"]["wheel"]
    assert "primkit" in wheel["only-include"]
    assert [rule for rule in wheel["exclude"] if not rule.startswith(("/notebooks/", "/data/"))] == []
    front_end = [f"primkit/scene/{name}" for name in ("board.js", "hand.js", "scene.js", "replay.js", "scene.css")]
    read = [*front_end, "primkit/__init__.pyi"]
    assert all((ROOT / name).is_file() for name in read)
    ignored = (ROOT / ".gitignore").read_text(encoding="utf-8").splitlines()
    rules = [line.strip("/") for line in ignored if line and not line.startswith("#")]
    assert [(name, rule) for name in read for rule in rules if PurePosixPath(name).match(rule)] == []


def script(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, ROOT / ".ci" / f"{name}.py")
    assert spec
    assert spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def readme_block() -> ModuleType:
    return script("readme_block")


def test_the_package_s_page_promises_nothing_that_lies_in_the_folder_alone() -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    told = script("package_page").page(readme, "me/kit", "1.0")
    assert re.findall(r"\]\((?!https://)[^)]*\)", told) == []
    only_here = r"python -m (?!pip\b)[\w.]+|\.venv|environment\.txt|notebooks/\w+\.ipynb|<!-- (?:folder|package)"
    assert re.findall(only_here, told) == []
    assert len(re.findall(only_here, readme)) > 9


@pytest.mark.parametrize("name", ["tests", "tests on Windows"])
def test_readme_gives_the_commands(readme_block: ModuleType, name: str) -> None:
    commands = readme_block.block((ROOT / "README.md").read_text(encoding="utf-8"), name)
    assert "-m pytest" in commands.splitlines()[-1]


MARKED = "<!-- ci: tests -->\n```bash\nmake && test\n```\n"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (MARKED, "make && test\n"),
        (f"# Title\n\n{MARKED}\nmore\n```\nother\n```\n", "make && test\n"),
        (f"<!-- ci: tests on Windows -->\n```\nother\n```\n{MARKED}", "make && test\n"),
        (MARKED.replace("-->\n", "-->\n\n"), "make && test\n"),
        (MARKED.replace("&& ", "\n"), "make \ntest\n"),
    ],
    ids=["alone", "among others", "beside another marker", "an empty line between", "two lines"],
)
def test_block_after_a_marker_is_found(readme_block: ModuleType, text: str, expected: str) -> None:
    assert readme_block.block(text, "tests") == expected


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "must hold the marker <!-- ci: tests --> once, found 0"),
        (MARKED * 2, "must hold the marker <!-- ci: tests --> once, found 2"),
        ("<!-- ci: tests -->\nwords\n```\nother\n```\n", "a fenced block with commands must follow"),
        ("<!-- ci: tests -->\n```\n```\n", "a fenced block with commands must follow"),
    ],
    ids=["no marker", "twice", "words between", "empty"],
)
def test_block_after_a_marker_failure(readme_block: ModuleType, text: str, message: str) -> None:
    with pytest.raises(SystemExit, match=message):
        readme_block.block(text, "tests")
