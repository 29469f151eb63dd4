"""Tasks on a Dask cluster; dask is imported only when one is asked for."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

RETRIES = 3
"""How often a task is tried again after an error; those of lost workers always are."""

MISSING = 'studies on a cluster need dask: install it with pip install "gear_dynamics[cluster]"'


class ClusterError(RuntimeError):
    """The cluster cannot be used; the message says why."""


def connect(address: str) -> Any:
    """Return a Dask client of the scheduler at the address; `local` starts one here.

    Raises
    ------
    ClusterError
        If dask is not installed or nothing answers there.
    """
    try:
        from distributed import Client
    except ModuleNotFoundError:
        raise ClusterError(MISSING) from None
    if address == 'local':
        # One thread a worker: Numba's own threads must not be entered twice at once. And one for
        # Numba, as there is a worker for each core.
        return Client(
            n_workers=os.cpu_count(),
            threads_per_worker=1,
            dashboard_address=None,
            env={'NUMBA_NUM_THREADS': '1'},
        )
    try:
        return Client(address, timeout='10s')
    except (OSError, ValueError) as error:
        raise ClusterError(f'no Dask scheduler answers at {address}: {error}') from None


def map_on_cluster(
    client: Any,
    task: Callable[..., dict[str, np.ndarray]],
    arguments: Sequence[dict[str, Any]],
    which: Sequence[int],
) -> Iterator[tuple[int, dict[str, np.ndarray]]]:
    """Yield number and result of each task of `which`, as they are finished."""
    from distributed import as_completed

    futures = {
        client.submit(_call, task, arguments[i], pure=False, retries=RETRIES): i for i in which
    }
    for future, result in as_completed(futures, with_results=True):
        yield futures[future], result


def _call(
    task: Callable[..., dict[str, np.ndarray]], arguments: dict[str, Any]
) -> dict[str, np.ndarray]:
    return task(**arguments)
