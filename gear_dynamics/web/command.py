"""The `dashboard` executable: the live page in the browser."""

from __future__ import annotations

import argparse
import asyncio
import importlib
import signal
import sys
from collections.abc import Sequence

from gear_dynamics.model.faults import KINDS
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.parameters.files import read_parameters
from gear_dynamics.parameters.parameter import ParameterError
from gear_dynamics.parameters.settings import DashboardSettings, SimSettings
from gear_dynamics.web.address import cannot_listen, lines_of_address
from gear_dynamics.web.hub import Hub
from gear_dynamics.web.local import LocalMachine
from gear_dynamics.web.server import PageServer


def main(argv: Sequence[str] | None = None) -> int:
    """Run `dashboard` and return its exit code.

    With --local the machine runs in this process; without it the page shows the topics of ROS 2.
    """
    arguments = list(sys.argv[1:] if argv is None else argv)
    if '--local' not in arguments:
        node = importlib.import_module('gear_dynamics.nodes.dashboard')
        return node.main(arguments)
    return _local(_parser().parse_args(arguments))


def _parser() -> argparse.ArgumentParser:
    settings = {about.name: about for about in DashboardSettings.parameters()}
    parser = argparse.ArgumentParser(
        prog='gear-dynamics dashboard',
        description='Show a gear pair live in the browser; without --local, that of the topics.',
    )
    parser.add_argument('--local', action='store_true', help='run the machine in this process')
    parser.add_argument('--params', help='parameter file of the machine (ROS YAML)')
    for name, about in settings.items():
        parser.add_argument(
            f'--{name.replace("_", "-")}',
            dest=name,
            type=type(about.default),
            default=about.default,
            help=f'{about.description} (default {about.default})',
        )
    return parser


def _local(arguments: argparse.Namespace) -> int:
    try:
        page = DashboardSettings(address=arguments.address, port=arguments.port)
        pair, settings = GearPair(), SimSettings()
        if arguments.params:
            pair = GearPair.from_yaml(arguments.params)
            settings = SimSettings.from_mapping(read_parameters(arguments.params))
    except ParameterError as error:
        return _refuse(str(error))
    return asyncio.run(_serve(page, pair, settings))


async def _serve(page: DashboardSettings, pair: GearPair, settings: SimSettings) -> int:
    hub = Hub('the machine starts; a first start compiles it', tuple(KINDS))
    server = PageServer(hub, page.address, page.port)
    try:
        await server.start()
    except OSError as error:
        return _refuse(cannot_listen(page, error))
    print('\n'.join(lines_of_address(page, server)), flush=True)
    stop = asyncio.Event()
    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: loop.call_soon_threadsafe(stop.set))
    machine = LocalMachine(hub, pair, settings)
    machine.start()
    await stop.wait()
    machine.stop()
    await server.stop()
    return 0


def _refuse(line: str) -> int:
    print(f'gear-dynamics dashboard: {line}', file=sys.stderr)
    return 2


if __name__ == '__main__':
    sys.exit(main())
