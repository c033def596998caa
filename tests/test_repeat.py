"""The paper's experiments repeated: its printed tables against its rows, and a few rows that must come back."""

import numpy as np
import pytest

import primkit as pk
from primkit.study import PUBLISHED, Row, Score, agrees, repeat_study, row_table, tables
from tests.benchmarks.ablation import STEPS, ablation

SUITE = pk.published_suite()

# Tables 1 to 4 as they are printed in the paper: total, shape type, centre position, shape measurements, time [s].
PRINTED = {
    ("automatic", "1_circle"): (1.0, 1.0, 1.0, 1.0, 10.03),
    ("automatic", "1_triangulo"): (0.85, 1.0, 0.50, 1.0, 9.43),
    ("automatic", "1_quadrado"): (0.85, 1.0, 1.0, 0.50, 9.48),
    ("automatic", "1_pentagon"): (0.70, 1.0, 1.0, 0.0, 9.70),
    ("automatic", "1_"): (0.85, 1.0, 0.875, 0.63, 9.66),
    ("automatic", "2_"): (0.83, 1.0, 0.85, 0.57, 10.37),
    ("automatic", "3_"): (0.83, 1.0, 0.87, 0.57, 10.70),
    ("automatic", "4_"): (0.87, 1.0, 0.92, 0.67, 12.03),
    ("manual", "1_circle"): (1.0, 1.0, 1.0, 1.0, 13.50),
    ("manual", "1_triangulo"): (0.55, 1.0, 0.5, 0.0, 12.77),
    ("manual", "1_quadrado"): (0.85, 1.0, 1.0, 0.50, 14.18),
    ("manual", "1_pentagon"): (0.70, 1.0, 1.0, 0.0, 13.45),
    ("manual", "1_"): (0.77, 1.0, 0.875, 0.38, 13.48),
    ("manual", "2_"): (0.72, 1.0, 0.70, 0.38, 28.34),
    ("manual", "3_"): (0.67, 0.86, 0.68, 0.40, 39.25),
    ("manual", "4_"): (0.80, 1.0, 0.83, 0.50, 58.25),
}


def is_printed(means, figures):
    """Whether means are printed so: rounded to two decimals (0.625 as 0.63, 10.694 as 10.7), or cut (0.839 as 0.83)."""
    above = np.subtract(means, figures)
    return (above > -0.0065) & (above < 0.0099)


def recorded(movement, start, without=()):
    chosen = {name: row for name, row in PUBLISHED[movement].items() if name.startswith(start) and name not in without}
    return np.array([(*vars(row.score).values(), row.time) for row in chosen.values()])


def test_there_are_68_rows():
    assert [len(rows) for rows in PUBLISHED.values()] == [34, 34]
    assert list(PUBLISHED["automatic"]) == list(PUBLISHED["manual"]) == list(SUITE)


@pytest.mark.parametrize(("movement", "start"), [key for key in PRINTED if key not in {("manual", "3_")}])
def test_the_printed_tables_are_the_means_of_the_rows(movement, start):
    same = is_printed(recorded(movement, start).mean(axis=0), PRINTED[movement, start])
    assert same.tolist() == [True, True, (movement, start) != ("automatic", "4_"), True, True]


def test_the_first_slip_is_a_centre_of_0_92():
    center = recorded("automatic", "4_").mean(axis=0)[2]
    assert center == pytest.approx(0.902)
    assert PRINTED["automatic", "4_"][2] == 0.92


def test_the_second_slip_is_nine_rows_divided_by_ten():
    nine = recorded("manual", "3_", without=["3_map_1"])
    assert len(nine) == 9
    assert is_printed(nine.sum(axis=0) / 10, PRINTED["manual", "3_"]).all()
    assert recorded("manual", "3_").mean(axis=0) == pytest.approx([0.762, 0.967, 0.784, 0.467, 43.026], abs=1e-3)
    assert not is_printed(recorded("manual", "3_").mean(axis=0), PRINTED["manual", "3_"]).any()


# --- repeated -----------------------------------------------------------------------------------------------

CERTAIN = ("1_circle", "1_quadrado", "1_triangulo", "1_pentagon", "2_rectanglerectangle", "4_mapa_4")


@pytest.fixture(scope="module")
def again() -> list[Row]:
    return repeat_study(["automatic", "manual"], names=CERTAIN, jobs=1)


def test_rows_come_back_in_all_four_numbers(again):
    theirs = {row.map: row for row in again if row.sensor == "webots" and row.movement == "automatic"}
    assert {name: agrees(row) for name, row in theirs.items()} == {name: name != "4_mapa_4" for name in CERTAIN}


def test_like_stands_beside_like(again):
    first, several, *driven = tables(again)
    lines = [(line.method, line.scoring) for line in several.lines if line.maps == "2 shapes"]
    assert lines == [("recorded", ""), ("PAPER repeated", ""), ("PAPER", "within 5 mm"), ("ROBUST", "within 5 mm")]
    assert "The same as recorded in all four numbers: 4 of 4 rows." in first.notes
    assert any(note.startswith("Printed in the paper for 4 shapes") for note in several.notes)
    assert any("nine rows divided by ten" in note for note in driven[1].notes)
    assert [line.means[2].value for line in several.lines if line.method == "recorded"] == [1.0, 1.0]


def test_row_by_row(again):
    table = row_table(again)
    assert table.rows[0] == ("1_circle, automatic", "1.00 1.00 1.00 1.00", "1.00 1.00 1.00 1.00", "the same")
    assert len(table.rows) == 2 * len(CERTAIN)
    assert table.csv().splitlines()[1].startswith("automatic,1_circle,True,False,1.0,")


def test_a_crashed_run_is_told_and_not_counted():
    """Two survive of three; the mean as published is theirs, and that with the crash as zero stands beside it."""
    world = pk.World([pk.Circle((0, 0), 0.1)])
    (row,) = pk.run_study({"a": world}, {"PAPER": pk.PAPER}, lidar=pk.Lidar(model="webots"), jobs=1)
    none, half = Score(0.0, 0.0, 0.0, 0.0), Score(0.5, 0.5, 0.5, 0.5)
    rows = [vars(row) | {"paper": half} for _ in range(2)] + [vars(row) | {"paper": none, "crashed": True}]
    (table,) = tables([Row(**values) for values in rows])
    shown = [(line.method, line.scoring, line.n, line.means[0].value) for line in table.lines if line.maps == "circle"]
    assert shown == [
        ("PAPER repeated", "(2 of 3 survived)", 2, 0.5),
        ("PAPER repeated", "crashes as 0", 3, pytest.approx(1 / 3)),
    ]
    assert "PAPER repeated (2 of 3 survived)" in str(table)


def test_the_rendered_sensor_errs_by_millimetres():
    """Raw hits against the nearest outline: what its re-enactment for the paper's worlds must show."""
    off = []
    for world in SUITE.values():
        points = pk.scan(world, pk.robot.published_poses(), pk.Lidar(model="webots")).points()
        off.append(np.min([np.abs(shape.signed_distance(points)) for shape in world.shapes], axis=0))
    millimetres = 1000 * np.concatenate(off)
    assert np.sqrt(np.mean(millimetres**2)) == pytest.approx(1.7, abs=0.2)
    assert np.percentile(millimetres, 95) == pytest.approx(4.1, abs=0.4)
    assert millimetres.max() < 9


def test_the_rectangle_of_the_paper_s_figure_3():
    """Figure 3 shows 118 x 144 mm for a rectangle of 110 x 140."""
    world, grid = SUITE["4_mapa_4"], pk.Grid()
    grid.add(pk.scan(world, pk.robot.published_poses(), pk.Lidar(model="webots")))
    found = pk.find_shapes(grid.points(), 4, settings=pk.PAPER, rng=0)
    (rectangle,) = [one.shape for one in found if one.kind == "rectangle"]
    assert np.abs(np.array(rectangle.dimensions) - (0.144, 0.118)).max() <= 0.003


def test_the_ablation_tells_each_step():
    table = ablation([0], [STEPS[-1]])
    assert [row[0] for row in table.rows] == ["+ wrong kinds crash, not counted"]
    assert 0.8 < float(table.rows[0][1]) < 0.9


def test_a_fit_that_is_told_the_sides_fits_on_the_rendered_sensor_too():
    """There is no true hit: a point belongs to the side that it is nearest to, and every point to one."""
    lidar = pk.Lidar(model="webots")
    for name in ("1_circle", "1_quadrado", "1_triangulo", "1_pentagon"):
        points, owners = pk.study.told_points(SUITE[name], pk.scan(SUITE[name], pk.published_poses(), lidar), lidar)
        assert (owners[:, 0] == 0).all()
        assert len(points) == len(owners)
        assert pk.evaluate(pk.study.oracle_fit(SUITE[name], points, owners), SUITE[name]).weighted_accuracy == 1


def test_the_robot_stands_where_the_paper_s_stood():
    """On its own sensor: not at the first way-point, but in shapes, too; on exact rays where it can stand."""
    world = SUITE["4_mapa_4"]
    for model, scans in (("webots", 76), ("exact", len(pk.teleport_poses(world)))):
        run = pk.study.run(pk.study.Experiment("m", world, "ROBUST", pk.ROBUST, lidar=pk.Lidar(model=model)))
        assert len(run.scans) == scans
        assert np.unique(np.degrees(run.scans.poses[:, 2])).round(9).tolist() == [0.15 if model == "webots" else 0.0]
