"""The list of mutants follows the code, and a mutant that no test notices is told from one that is caught."""

import pytest

from tests.benchmarks.robust_mutants import MUTANTS, ROOT, Mutant, outcome


@pytest.mark.parametrize("mutant", MUTANTS, ids=[mutant.what for mutant in MUTANTS])
def test_the_piece_stands_in_its_file_once_and_its_tests_are_there(mutant):
    assert (ROOT / "primkit" / mutant.file).read_text(encoding="utf-8").count(mutant.old) == 1
    assert mutant.new != mutant.old
    assert all((ROOT / "tests" / name).exists() for name in mutant.tests)


@pytest.fixture
def folder(tmp_path):
    """A package of one line, half of which is tested."""
    for name in ("primkit", "tests"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "__init__.py").touch()
    (tmp_path / "primkit/halves.py").write_text("ONE, OTHER = 1, 2\n")
    (tmp_path / "tests/test_one.py").write_text(
        "from primkit.halves import ONE\n\ndef test_one():\n    assert ONE == 1\n"
    )
    return tmp_path


@pytest.mark.parametrize(
    ("new", "reason", "said"),
    [
        ("3, 2", "", "caught, FAILED tests/test_one.py::test_one"),
        ("1, 3", "", "SURVIVED"),
        ("1, 2.0", "2.0 is 2", "equivalent: 2.0 is 2"),
    ],
)
def test_what_becomes_of_a_mutant(folder, new, reason, said):
    assert outcome(Mutant("a number", "halves.py", "1, 2", new, ("test_one.py",), reason), folder) == said
    assert (folder / "primkit/halves.py").read_text() == "ONE, OTHER = 1, 2\n"


@pytest.mark.parametrize("old", ["5", ""])
def test_a_piece_that_is_not_there_once_is_an_error(folder, old):
    with pytest.raises(ValueError, match="exactly once"):
        outcome(Mutant("gone", "halves.py", old, "6", ("test_one.py",)), folder)
