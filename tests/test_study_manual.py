"""Manual movement in a study: what was seen, how right each shape is by itself, and Tables 3 and 4."""

import csv
import io
import re
from dataclasses import replace

import numpy as np
import pytest

import primkit as pk
from primkit.evaluation import evaluate
from primkit.lidar import Lidar, scan
from primkit.pipeline import ROBUST
from primkit.study import Row, Score, drives_on, rows_as_csv, run_study, seen_table, tables
from primkit.study.experiment import Experiment, perform, run
from primkit.study.oracle import shares_seen

HALF = [(0.0, 0.0, 0.0), (0.0, 0.02, 0.0)]
TWO = pk.World([pk.Circle((0.2, 0.0), 0.06), pk.Polygon([(-0.25, -0.2), (-0.15, -0.2), (-0.15, 0.1), (-0.25, 0.1)])])


def test_the_share_that_was_seen_by_hand():
    """From afar nearly half of a circle, and the side of a rectangle that faces the robot: 0.3 m of 0.8 m."""
    poses = np.column_stack([np.zeros(41), np.linspace(-0.2, 0.1, 41), np.zeros(41)])
    circle, rectangle = shares_seen(TWO, scan(TWO, poses), Lidar())
    assert 0.4 < circle < 0.8
    assert rectangle == pytest.approx((0.3 + 2 * 0.012) / 0.8, abs=0.02)
    assert shares_seen(TWO, scan(TWO, []), Lidar()) == (0.0, 0.0)


def test_a_faulty_sensor_has_seen_as_much_as_a_faultless_one():
    lidar = Lidar(noise_std=0.01, dropout=0.5, spurious=0.3)
    assert shares_seen(TWO, scan(TWO, HALF, lidar, rng=0), lidar) == shares_seen(TWO, scan(TWO, HALF), Lidar())


def test_a_row_says_what_the_drive_saw_and_only_of_a_drive():
    driven = perform(Experiment("two", TWO, "ROBUST", ROBUST, drive=np.array(HALF)))
    assert driven.seen == shares_seen(TWO, scan(TWO, HALF), Lidar())
    assert len(driven.seen) == 2
    assert perform(Experiment("two", TWO, "ROBUST", ROBUST)).seen == ()


@pytest.mark.parametrize("seed", range(4))
def test_the_scores_by_shape_are_those_of_the_shapes_alone(seed):
    """Each shape judged by the report of all: its own pair, or nothing where it was missed."""
    world = pk.random_world(4, rng=seed)
    trial = Experiment(
        "m", world, "ROBUST", ROBUST, Lidar(noise_std=0.008), seed=seed, drive=pk.teleport_poses(world)[::3]
    )
    report = evaluate(run(trial).found, world)
    pairs = {id(match.true): match for match in report.matches}
    row = perform(trial)
    for shape, score in zip(world.shapes, row.scores_by_shape(), strict=True):
        match = pairs.get(id(shape))
        expected = (0.0, 0.0, 0.0)
        if match is not None:
            sides = {"circle": 1, "triangle": 3, "rectangle": 2, "pentagon": 5}[shape.kind]
            right = sum(match.dimension_right) / sides if match.kind_right else 0.0
            expected = (float(match.kind_right), sum(match.center_right) / 2, right)
        assert (score.shape, score.center, score.dimension) == pytest.approx(expected)
        assert score.weighted == pytest.approx(0.4 * expected[0] + 0.3 * expected[1] + 0.3 * expected[2])
    assert row.n_false == len(report.false_alarms)


def test_what_was_seen_survives_the_journal(tmp_path):
    first, second = (
        run_study({"two": TWO}, {"ROBUST": ROBUST}, drives={"two": HALF}, folder=tmp_path, jobs=1) for _ in "12"
    )
    assert first == second
    assert (first[0].seen, first[0].seen != ()) == (second[0].seen, True)


GOOD = Score(1.0, 1.0, 1.0, 1.0)
BASE = Row("a", "ROBUST", ("circle", "circle"), "manual", 0.005, False, 3, GOOD, GOOD, (0.0,) * 4, (0.0,) * 2, 3.0, 0.1)
ROWS = [
    replace(BASE, found_as=("circle", "circle"), seen=(1.0, 0.6), n_found=2),
    # The second shape was taken for a pentagon, one coordinate of its centre is off; and something is there in vain.
    replace(
        BASE,
        map="b",
        found_as=("circle", "pentagon"),
        seen=(0.9, 0.59),
        center_errors=(0.0, 0.0, 0.006, 0.0),
        dimension_errors=(0.0051,),
    ),
    replace(BASE, map="c", found_as=(None, None), seen=(0.7, 0.0), center_errors=(), dimension_errors=(), n_found=0),
]


def test_a_table_of_what_was_seen_computed_by_hand():
    table = seen_table([*ROWS, replace(BASE, movement="automatic", found_as=("circle",) * 2)])
    assert str(table).startswith("""\
Shapes by how much of their outline was seen, manual movement

                     total                shape  centre  dimensions
-------------------  -------------------  -----  ------  ----------
seen on 60 % or more: 4 of 6 shapes, on 3 maps
 ROBUST within 5 mm  0.675 (0.000-1.000)  0.750  0.750   0.500
seen on less: 2 of 6 shapes, on 2 maps
 ROBUST within 5 mm  0.075 (0.000-0.150)  0.000  0.250   0.000
""")
    assert "counts in Tables 3 and 4 alone: ROBUST 1." in table.notes[1]
    assert max(map(len, str(table).splitlines())) <= 80
    for line in table.lines:
        assert str(line.means[0]) in table._repr_html_()
    lines = list(csv.DictReader(io.StringIO(table.csv())))
    assert [(line["map"], line["found_as"], line["seen"], line["weighted"]) for line in lines] == [
        ("a", "circle", "1.0", "1.0"),
        ("a", "circle", "0.6", "1.0"),
        ("b", "circle", "0.9", "0.7"),
        ("b", "pentagon", "0.59", "0.15"),
        ("c", "", "0.7", "0.0"),
        ("c", "", "0.0", "0.0"),
    ]


def test_no_shapes_no_lines():
    assert seen_table([]).lines == ()
    assert seen_table([replace(BASE, kinds=(), found_as=(), seen=())]).lines == ()
    assert [line.maps for line in seen_table(ROWS[:1]).lines] == ["seen on 60 % or more: 2 of 2 shapes, on 1 map"]


def test_who_drove_is_told_below_the_manual_tables_alone():
    made = tables([ROWS[0], replace(BASE, movement="automatic")], driven="By a script.")
    assert [table.title[:7] for table in made] == ["Table 2", "Table 4"]
    assert ["By a script." in table.notes for table in made] == [False, True]
    assert "By a script." not in tables(ROWS[:1])[0].notes


def test_the_bundled_drives_lead_to_tables_3_and_4_and_to_right_shapes():
    """At least 0.90 of what was seen on at least 60 %, within 5 mm, shape by shape, and told nothing."""
    maps = pk.paper_suite()
    rows = run_study(maps, {"ROBUST": ROBUST}, drives=drives_on(maps), jobs=1, progress=False)
    assert [table.title[:7] for table in tables(rows)] == ["Table 3", "Table 4"]
    assert rows_as_csv(rows).count("manual") == 34
    assert not any(row.told for row in rows)
    seen, *_ = seen_table(rows).lines
    group, n_shapes, n_all = re.match(r"(.*): (\d+) of (\d+) shapes", seen.maps).groups()
    assert (group, n_all) == ("seen on 60 % or more", "94")
    assert int(n_shapes) >= 80
    assert seen.means[0].value >= 0.90
