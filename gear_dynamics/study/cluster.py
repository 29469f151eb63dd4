"""Tasks on a Dask cluster; dask is imported only when one is asked for."""

from __future__ import annotations

import asyncio
import logging
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import CancelledError, ThreadPoolExecutor
from typing import Any

import numpy as np

from gear_dynamics.study.cache import code

ANSWER = 5.0
"""Time in which a scheduler must answer [s]."""

PATIENCE = 10.0
"""Time without any result after which it is said if there are no workers [s]."""

MISSING = 'studies on a cluster need dask: install it with pip install "gear_dynamics[cluster]"'

IGNORE_INTERRUPT = 'import signal; signal.signal(signal.SIGINT, signal.SIG_IGN)'
"""What workers of a local cluster run first: Ctrl-C reaches them too, but is for the study."""

GOES_ON = 'the same command goes on from what is finished'


class ClusterError(RuntimeError):
    """The cluster cannot be used; the message says why."""


class Cluster:
    """A Dask cluster that calls tasks.

    Dask gives the tasks of a lost worker to another, and the finished ones whose results were
    lost with it too: a study goes on as long as there are workers. Only a task under which
    workers die again and again (four times by Dask's default) is given up.

    Parameters
    ----------
    address : str
        Of a scheduler; `local` starts one here, with a worker for each core.

    Raises
    ------
    ClusterError
        If dask is not installed or no scheduler answers at the address.
    """

    def __init__(self, address: str) -> None:
        self._address = address
        self._client = _start_local() if address == 'local' else _connect(address)
        # What it logs about lost workers is in vain: their tasks run elsewhere.
        for handler in logging.getLogger('distributed').handlers:
            handler.setLevel(logging.CRITICAL)

    def map(
        self,
        task: Callable[..., dict[str, np.ndarray]],
        arguments: Sequence[dict[str, Any]],
        which: Sequence[int],
    ) -> Iterator[tuple[int, dict[str, np.ndarray]]]:
        """Yield number and result of each task of `which`, as they are finished.

        Raises
        ------
        ClusterError
            If the scheduler is lost, a task is given up, or a worker has other code.
        """
        submit = self._client.submit
        try:
            futures = {submit(_call, task, arguments[i], code(), pure=False): i for i in which}
            for future in self._finished(set(futures)):
                yield futures[future], future.result()
        except Exception as error:
            line = self._explain(error, task.__name__)
            if line is None:
                raise
            raise ClusterError(line) from None

    def close(self) -> None:
        """Leave the cluster; a local one ends."""
        self._client.close()

    def _finished(self, waiting: set[Any]) -> Iterator[Any]:
        from distributed import wait

        said = ''
        while waiting:
            try:
                done, waiting = wait(waiting, PATIENCE, return_when='FIRST_COMPLETED')
            except asyncio.TimeoutError:
                said = self._say_why(said)
            else:
                yield from done

    def _explain(self, error: Exception, task: str) -> str | None:
        """Return what went wrong with the cluster and the remedy; None if it was the task."""
        from distributed import KilledWorker
        from distributed.comm import CommClosedError

        if isinstance(error, KilledWorker):
            return (
                f'{error.allowed_failures + 1} workers died with the same {task}, the last one at '
                f'{error.last_worker.address}: look into its log, perhaps it needs more memory; '
                f'{GOES_ON}'
            )
        if isinstance(error, CancelledError | CommClosedError) or self._client.status == 'closed':
            return f'the Dask scheduler at {self._address} was lost: start it again; {GOES_ON}'
        # The scheduler reads the task too.
        cause = error.__cause__ or error
        if isinstance(cause, ModuleNotFoundError):
            return (
                f'the Dask scheduler at {self._address} or a worker has no module {cause.name}: '
                'install the same packages there as here'
            )
        return None

    def _say_why(self, said: str) -> str:
        """Say once why no results come; return what was said."""
        line = 'the workers compile the model, or their tasks are long'
        if not self._client.scheduler_info()['workers']:
            line = f'the Dask scheduler at {self._address} has no workers: start one'
        if line != said:
            print(f'study: waiting: {line}', file=sys.stderr)
        return line


def _start_local() -> Any:
    Client = _distributed().Client
    # One thread a worker: Numba's own threads must not be entered twice at once. And one for
    # Numba, as there is a worker for each core.
    return Client(
        n_workers=os.cpu_count(),
        threads_per_worker=1,
        dashboard_address=None,
        silence_logs=logging.CRITICAL,
        preload=[IGNORE_INTERRUPT],
        env={'NUMBA_NUM_THREADS': '1'},
    )


def _connect(address: str) -> Any:
    distributed = _distributed()
    try:
        # A client of something else than a scheduler could not be closed. The thread: there may
        # be a loop in this one, as in Jupyter.
        with ThreadPoolExecutor(1) as thread:
            kind = thread.submit(asyncio.run, _kind(address)).result()
        if kind != 'Scheduler':
            raise ValueError(f'it is a {kind}')
        return distributed.Client(address, timeout=ANSWER)
    except Exception as error:  # what comes depends on what answers there, and how
        raise ClusterError(
            f'no Dask scheduler answers at {address} ({error}): start one with "dask scheduler", '
            'or give "local"'
        ) from None


async def _kind(address: str) -> str:
    """Return what answers at an address."""
    from distributed import Security
    from distributed.core import rpc

    security = Security().get_connection_args('client')
    async with rpc(address, timeout=ANSWER, connection_args=security) as there:
        identity = await asyncio.wait_for(there.identity(), ANSWER)
    return identity['type']


def _distributed() -> Any:
    try:
        import distributed
    except ModuleNotFoundError:
        raise ClusterError(MISSING) from None
    return distributed


def _call(
    task: Callable[..., dict[str, np.ndarray]], arguments: dict[str, Any], asked: dict[str, str]
) -> dict[str, np.ndarray]:
    """Call a task on a worker, if its code is that of the machine that asked."""
    if code() != asked:
        from distributed import get_worker

        others = [
            f'{name} {value}, not {asked[name]}'
            for name, value in code().items()
            if value != asked[name]
        ]
        raise ClusterError(
            f'the worker at {get_worker().address} has {"; ".join(others)}: install the same there'
        )
    return task(**arguments)
