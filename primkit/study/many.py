"""Study: many maps, many methods, in parallel.

In:  worlds (a dict by name, or any iterable), settings by name, the sensor, a seed.
Out: a list of ``Row``: one for each map and settings, with the scores under both protocols, errors and times.

>>> from primkit.world import random_world
>>> rows = run_study([random_world(2, rng=seed) for seed in (0, 1)], {"ROBUST": ROBUST}, jobs=1)
>>> [(row.map, row.settings, row.fair.weighted) for row in rows]
[('1', 'ROBUST', 1.0), ('2', 'ROBUST', 1.0)]

A study can be killed at any time: each finished row goes to a journal, and the same call continues where the last
one stopped. Scores and errors depend neither on that nor on the number of workers: each map has random numbers of
its own, from the study's seed, the map's name and its shapes.

Source: the paper's section 3.3, "Results"; its 34 maps are ``formats.published_suite``.
"""

from __future__ import annotations

import os
import signal
import sys
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sized
from contextlib import closing, contextmanager
from functools import cache
from multiprocessing import resource_tracker
from pathlib import Path
from threading import Thread
from time import sleep
from typing import Any, TypeVar

from numpy.typing import ArrayLike

from ..arguments import as_count, as_poses, as_positive, check_type, short
from ..formats import MAP_ENDINGS, StrPath, load_world, published_suite
from ..lidar import Lidar, as_lidar
from ..pipeline import PAPER, ROBUST, Settings
from ..world import World
from .experiment import Experiment, perform
from .journal import JOURNAL, append, open_journal
from .oracle import Oracle
from .row import Row

T = TypeVar("T")

METHODS: Mapping[str, Settings] = {"PAPER": PAPER, "ROBUST": ROBUST}


def run_study(
    worlds: Mapping[str, World] | Iterable[World] | None = None,
    settings: Mapping[str, Settings | Oracle] = METHODS,
    *,
    lidar: Lidar | None = None,
    tolerance: float | None = None,
    seed: int = 0,
    drives: Mapping[str, ArrayLike] | None = None,
    folder: StrPath | None = None,
    jobs: int | None = -1,
    progress: bool = True,
) -> list[Row]:
    """Map every world with every method, and say how right each is.

    Parameters
    ----------
    worlds : dict of str to World, or iterable of World, optional
        The maps; the paper's 34 when not given. An iterable's are called "1", "2", and so on, and are drawn as
        they are needed: thousands need no more memory than a few.
    settings : dict of str to Settings
        The methods by name. The published one is told the number of shapes when it groups by K-Means, the others
        find it. ``ORACLE`` is the fit that is told which point belongs to which side.
    lidar : Lidar, optional
        The sensor; the paper's, of each board's scale, by default. All methods get the same scans of a map.
    tolerance : float, optional
        Of the fair protocol, in metres; 5 mm, times each board's scale, when not given.
    seed : int
        The same seed gives the same rows, bit for bit, times apart.
    drives : dict of str to array_like, shape (P, 3), optional
        For each map, the poses of a drive to scan from; the way-points when not given.
    folder : str or path, optional
        Where the journal is kept, in ``journal.jsonl``; made when it is not there. A row that it holds is not
        computed again, unless the map, the method, the sensor, the seed or the program has changed.
    jobs : int, optional
        Number of processes; -1 for one on each core. None leaves it to ``joblib.parallel_config``, which also
        chooses another backend; ``on_cluster`` uses it. Times are most comparable with 1.
    progress : bool
        Show a progress bar on stderr, when that is a terminal.

    Returns
    -------
    list of Row
        In the order of the worlds, and for each in the order of the settings.

    Raises
    ------
    ValueError
        If an argument is out of its range, a drive is missing, or the journal holds something else than rows.
    OSError
        If the journal cannot be written.

    Examples
    --------
    >>> run_study([], jobs=1)
    []
    """
    common = {
        "tolerance": tolerance if tolerance is None else as_positive(tolerance, "tolerance", zero=True),
        "seed": as_count(seed, "seed", least=0),
    }
    as_lidar(lidar)  # refused before anything is done
    for chosen in settings.values():
        check_type(chosen, (Settings, Oracle), "each of the settings must be Settings")
    jobs, worlds = checked_jobs(jobs), published_suite() if worlds is None else worlds
    experiments = _experiments(worlds, settings, lidar, drives, common)
    total = len(worlds) * len(settings) if isinstance(worlds, Sized) else None
    return perform_all(experiments, folder=folder, jobs=jobs, total=total, progress=progress)


def perform_all(
    experiments: Iterable[Experiment],
    *,
    folder: StrPath | None = None,
    jobs: int | None = -1,
    total: int | None = None,
    progress: bool = True,
) -> list[Row]:
    """Perform experiments of any sort, in parallel; rows in their order. See ``run_study`` for the arguments."""
    rows: dict[int, Row] = {}
    try:
        with open_journal(folder) as (done, file), _bar(total, progress) as bar:
            for number, row, key in _performed(experiments, done, rows, jobs):
                rows[number] = row
                append(file, row, key)
                bar.update(len(rows) - bar.n)
            bar.update(len(rows) - bar.n)
    except KeyboardInterrupt:
        if folder is None:
            raise
        journal = Path(folder) / JOURNAL
        raise KeyboardInterrupt(f"stopped; the same command continues, with what {journal} holds") from None
    return [rows[number] for number in sorted(rows)]


def maps_in(paths: Iterable[StrPath]) -> dict[str, World]:
    """Return the maps in files and folders, by the files' names without their endings.

    Raises
    ------
    ValueError
        If a folder holds no map, a file is no map, or two have the same name.
    OSError
        If a folder or file is not there, or cannot be read.

    Examples
    --------
    >>> maps_in([])
    {}
    """
    files: list[Path] = []
    for path in map(Path, paths):
        if not path.exists() and path.suffix.lower() not in MAP_ENDINGS:
            raise FileNotFoundError(f"{path}: there is no such folder in {path.absolute().parent}")
        inside = sorted(p for p in path.iterdir() if p.suffix.lower() in MAP_ENDINGS) if path.is_dir() else [path]
        if not inside:
            raise ValueError(f"{path}: must hold maps ({' or '.join(MAP_ENDINGS)}), got none")
        files += inside
    maps = {file.stem: load_world(file) for file in files}
    if len(maps) < len(files):
        raise ValueError(f"maps must have different names, got {len(files)} files with {len(maps)} names")
    return maps


# --- the work -----------------------------------------------------------------------------------------------


def _experiments(
    worlds: Mapping[str, World] | Iterable[World],
    settings: Mapping[str, Settings | Oracle],
    lidar: Lidar | None,
    drives: Mapping[str, ArrayLike] | None,
    common: Mapping[str, Any],
) -> Iterator[Experiment]:
    """Yield what is to be done, map by map; the worlds are drawn one after the other."""
    named = worlds.items() if isinstance(worlds, Mapping) else ((str(k), w) for k, w in enumerate(worlds, start=1))
    for map_name, world in named:
        check_type(world, World, "each of the worlds must be World")
        if drives is not None and map_name not in drives:
            raise ValueError(f"drives must hold one for each map, got none for {map_name!r}")
        drive = None if drives is None else as_poses(drives[map_name])
        for name, chosen in settings.items():
            yield Experiment(map_name, world, name, chosen, lidar=as_lidar(lidar, world.scale), drive=drive, **common)


def _performed(
    experiments: Iterable[Experiment], done: Mapping[str, Row], rows: dict[int, Row], jobs: int | None
) -> Iterator[tuple[int, Row, str]]:
    """Yield (number, row, key) of each experiment as it ends; those done before go to ``rows``."""
    keys: dict[int, str] = {}
    failures: list[Exception] = []

    def waiting() -> Iterator[tuple[Any, ...]]:
        try:
            for number, experiment in enumerate(experiments):
                key = experiment.key()
                if key in done:
                    rows[number] = done[key]
                else:
                    keys[number] = key
                    yield _numbered, number, experiment
        except Exception as error:  # a world that cannot be drawn: what runs by now is to end, and be written, first
            failures.append(error)

    # Only as many experiments as the workers need next are made ahead: all of them are never in memory at once.
    with _running(waiting(), jobs, ordered=False) as results:
        for number, row in results:
            yield number, row, keys.pop(number)
    if failures:
        raise failures[0]


def in_parallel(
    function: Callable[..., T], work: Iterable[tuple[Any, ...]], *, jobs: int | None, progress: bool, unit: str
) -> list[T]:
    """Return what a function makes of each of the arguments, in their order; nothing is kept in a journal."""
    tasks = [(function, *arguments) for arguments in work]
    done: list[T] = []
    with _running(tasks, jobs, ordered=True) as results, _bar(len(tasks), progress, unit) as bar:
        for result in results:
            done.append(result)
            bar.update()
    return done


@contextmanager
def _running(tasks: Iterable[tuple[Any, ...]], jobs: int | None, *, ordered: bool) -> Iterator[Iterable[Any]]:
    """Call each task's function with its arguments in child processes; the results come as they are done.

    What still runs in the end is cut short; joblib's advice on that is not for who pressed Ctrl-C.
    """
    from joblib import Parallel, delayed

    calls = (delayed(_as_child)(os.getpid(), *task) for task in tasks)
    with _deaf_children(jobs):
        running = Parallel(n_jobs=jobs, return_as="generator" if ordered else "generator_unordered")(calls)
    with warnings.catch_warnings(), closing(running) as results:
        warnings.filterwarnings("ignore", message=".*adjusting the input task iterator", category=UserWarning)
        yield results


@contextmanager
def _deaf_children(jobs: int | None) -> Iterator[None]:
    """Start processes that do not hear Ctrl-C: it is for their parent, which ends them without a word.

    A terminal sends the signal to all of them, and a process keeps the mask that it was started with.
    """
    if jobs == 1 or not hasattr(signal, "pthread_sigmask"):  # no children; Windows
        yield
        return
    resource_tracker.ensure_running()  # it comes with the first child, and up to Python 3.12 it lifts the mask
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _numbered(number: int, experiment: Experiment) -> tuple[int, Row]:
    return number, perform(experiment)


def _as_child(parent: int, function: Callable[..., T], *arguments: Any) -> T:
    """Call a function for a parent process: on one core alone, and in a process that ends with its parent."""
    from joblib import parallel_config

    _end_with(parent)
    with parallel_config(backend="sequential"):  # else scikit-learn would hand its own steps to the cluster's workers
        return function(*arguments)


@cache
def _end_with(parent: int) -> None:
    """Watch the parent, once in each process: when it is killed, its workers would wait for minutes."""
    if os.getppid() == parent:  # else this is the parent itself, or a machine elsewhere
        Thread(target=_watch, args=(parent,), daemon=True).start()
        if hasattr(signal, "pthread_sigmask"):  # before joblib 1.6, its own tracker lifts the mask at the start
            signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})


def _watch(parent: int) -> None:
    while os.getppid() == parent:  # an orphan is given another parent; not on Windows, where it lives on for a while
        sleep(0.5)
    os._exit(1)  # from a thread, nothing less ends a process


def _bar(total: int | None, progress: bool, unit: str = "row") -> Any:
    from tqdm import tqdm

    # disable=None: shown on a terminal only.
    return tqdm(total=total, unit=unit, file=sys.stderr, disable=None if progress else True, dynamic_ncols=True)


def checked_jobs(jobs: int | None) -> int | None:
    """Return the number of processes, or say in one sentence what is wrong."""
    if jobs is None or jobs == -1:
        return jobs
    try:
        return as_count(jobs, "jobs")
    except ValueError:
        raise ValueError(f"jobs must be a whole number >= 1, -1 for every core, or None, got {short(jobs)}") from None
