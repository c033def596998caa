"""Studies on a real dask cluster: two worker processes on this machine, one of which is killed in the middle."""

import sys
from dataclasses import astuple

import numpy as np
import pytest
from joblib.parallel import get_active_backend

from primkit.__main__ import main
from primkit.formats import save_world
from primkit.installed import install_line
from primkit.lidar import Lidar
from primkit.pipeline import ROBUST
from primkit.study import JOURNAL, Experiment, cluster, on_cluster, run_study
from primkit.study.many import in_parallel, perform_all
from primkit.world import random_world
from tests.helpers import exactly

distributed = pytest.importorskip("distributed", reason=f"dask is absent: {install_line('cluster')}")
psutil = pytest.importorskip("psutil")

NOISY = Lidar(noise_std=0.002)
N_MAPS = 8


def worlds():
    return (random_world(1 + seed % 2, rng=seed) for seed in range(N_MAPS))


@pytest.fixture(scope="module")
def workers():
    """The address of a cluster with two workers, and the processes; none of them outlives it."""
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0") as local:
        seen = [psutil.Process(worker.pid) for worker in local.workers.values()]
        yield local.scheduler_address, seen
        seen += [psutil.Process(worker.pid) for worker in local.workers.values()]  # one may have been started anew
    gone, alive = psutil.wait_procs(set(seen), timeout=10)
    assert len(gone) >= 2
    assert alive == []


def test_the_same_rows_although_a_worker_is_killed_in_the_middle(workers, tmp_path):
    address, processes = workers

    def drawn():
        for number, world in enumerate(worlds()):
            if number == N_MAPS // 2:  # both workers are busy with earlier ones
                processes[0].kill()
            yield world

    with on_cluster(address):
        rows = run_study(drawn(), {"ROBUST": ROBUST}, lidar=NOISY, folder=tmp_path, jobs=None)
    processes[0].wait(timeout=10)
    assert rows == run_study(worlds(), {"ROBUST": ROBUST}, lidar=NOISY, jobs=1)
    assert len((tmp_path / JOURNAL).read_bytes().splitlines()) == N_MAPS


def test_the_command_line_takes_the_address(workers, tmp_path, capsys):
    (tmp_path / "maps").mkdir()
    for seed in range(3):
        save_world(random_world(2, rng=seed), tmp_path / "maps" / f"{seed}.geojson")
    files = {}
    for name, more in (("cluster", ["--scheduler", workers[0]]), ("alone", ["--jobs", "1"])):
        words = ["study", "--maps", tmp_path / "maps", "--settings", "robust", "--out", tmp_path / name, *more]
        assert main(list(map(str, words))) == 0
        lines = (tmp_path / name / "rows.csv").read_text(encoding="utf-8").splitlines()
        files[name] = [line.rsplit(",", 1)[0] for line in lines]  # the last column is the measured time
    assert files["cluster"] == files["alone"]
    assert len(files["alone"]) == 4
    assert capsys.readouterr().out.count("Maps   3 with ROBUST; 0 of 3 results were in the journal already") == 2


def test_finished_rows_are_not_computed_again_elsewhere(workers, tmp_path):
    two = {"one": random_world(1, rng=1), "two": random_world(2, rng=2)}
    first = run_study(two, {"ROBUST": ROBUST}, folder=tmp_path, jobs=1)
    with on_cluster(workers[0]):
        again = run_study(two, {"ROBUST": ROBUST}, folder=tmp_path, jobs=None)
    assert [astuple(row) for row in again] == [astuple(row) for row in first]  # measured times too


def test_a_worker_keeps_its_own_steps_to_itself(workers):
    """scikit-learn runs some of its steps by joblib too: they once went out to the other workers, one by one."""
    with on_cluster(workers[0]):
        ask = lambda: type(get_active_backend()[0]).__name__  # noqa: E731 - goes out whole, as no function would
        assert in_parallel(ask, [()], jobs=None, progress=False, unit="task") == ["SequentialBackend"]


def test_an_error_on_a_worker_names_the_map(workers):
    nowhere = Experiment("far", random_world(1, rng=0), "ROBUST", ROBUST, drive=np.full((1, 3), np.nan))
    with pytest.raises(ValueError, match="poses must be finite") as caught, on_cluster(workers[0]):
        perform_all([nowhere], jobs=None)
    assert caught.value.__notes__ == ["on the map 'far' with the settings 'ROBUST'"]


# --- when there is none -------------------------------------------------------------------------------------


@pytest.fixture
def impatient(monkeypatch):
    monkeypatch.setattr(cluster, "ANSWER_TIMEOUT", 0.5)


@pytest.mark.usefixtures("impatient")
def test_nobody_at_the_address_is_one_sentence(tmp_path, capsys):
    address = "tcp://127.0.0.1:9"
    assert main(["study", "--scheduler", address, "--out", str(tmp_path)]) == 2
    out, err = capsys.readouterr()
    assert (out, err) == ("", f"primkit: no scheduler answers at {address}: start one with `dask scheduler`\n")


@pytest.mark.usefixtures("impatient")
def test_a_cluster_without_workers_is_one_sentence():
    with distributed.LocalCluster(n_workers=0, dashboard_address=":0") as empty:
        address = empty.scheduler_address
        sentence = f"the scheduler at {address} has no workers: start some with `dask worker {address}`"
        with pytest.raises(ConnectionError, match=exactly(sentence)), on_cluster(address):
            pass


def test_without_dask_it_says_how_to_get_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "dask.distributed", None)
    sentence = f"a cluster needs dask, which is not installed: {install_line('cluster')}"
    with pytest.raises(ValueError, match=exactly(sentence)), on_cluster("tcp://127.0.0.1:8786"):
        pass


@pytest.mark.parametrize("address", ["", "localhost", "tcp://localhost", "http://localhost:8786", "127.0.0.1:8786"])
def test_no_address(address):
    sentence = f"a scheduler's address must look like tcp://192.168.0.2:8786, got {address!r}"
    with pytest.raises(ValueError, match=exactly(sentence)), on_cluster(address):
        pass
