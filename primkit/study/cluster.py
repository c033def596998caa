"""Cluster: send a study's work to the workers of a dask cluster, on this machine or on many.

In:  the address of a running scheduler.
Out: a context; studies inside it, with ``jobs=None``, run on the cluster. Rows are the same as anywhere else.

    with on_cluster("tcp://192.168.0.2:8786"):
        rows = run_study(worlds, jobs=None)

A cluster is started by ``dask scheduler`` on one machine and ``dask worker tcp://...:8786`` on each that is to work;
all need primkit, in the same version. What a worker had in hand when it was lost is computed again by another.

Source: joblib's backend for dask; Rocklin (2015), "Dask: Parallel computation with blocked algorithms and task
scheduling".
"""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import contextmanager

from ..installed import install_line

ANSWER_TIMEOUT = 10.0  # s, for a scheduler to answer and for a first worker to join it


@contextmanager
def on_cluster(address: str) -> Iterator[None]:
    """Run the studies inside on a cluster, when their ``jobs`` is None.

    Parameters
    ----------
    address : str
        Of the scheduler, such as ``"tcp://192.168.0.2:8786"``.

    Raises
    ------
    ValueError
        If dask is not installed, or the address is none.
    OSError
        If there is no scheduler at the address, or it has no workers.

    Examples
    --------
    >>> with on_cluster("8786"):
    ...     pass
    Traceback (most recent call last):
        ...
    ValueError: a scheduler's address must look like tcp://192.168.0.2:8786, got '8786'
    """
    scheme, _, place = address.partition("://")
    if scheme not in ("tcp", "tls", "ws", "wss") or not place.rpartition(":")[2].isdigit():
        raise ValueError(f"a scheduler's address must look like tcp://192.168.0.2:8786, got {address!r}")
    try:
        from dask.distributed import Client
    except ModuleNotFoundError:
        raise ValueError(f"a cluster needs dask, which is not installed: {install_line('cluster')}") from None
    from joblib import parallel_config

    with _silence():  # while it tries, dask reports each attempt
        try:
            client = Client(address, timeout=ANSWER_TIMEOUT, set_as_default=False)
        except OSError:
            raise ConnectionError(f"no scheduler answers at {address}: start one with `dask scheduler`") from None
    with client:
        try:
            client.wait_for_workers(1, timeout=ANSWER_TIMEOUT)
        except TimeoutError:
            told = f"the scheduler at {address} has no workers: start some with `dask worker {address}`"
            raise ConnectionError(told) from None
        with parallel_config(backend="dask", client=client):
            yield


@contextmanager
def _silence() -> Iterator[None]:
    """Keep dask's reports off the screen."""
    logger = logging.getLogger("distributed")
    before = logger.level
    logger.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        logger.setLevel(before)
