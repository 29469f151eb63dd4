"""The demo: a gear pair streams, an analyzer listens and logs, and a picture comes out.

Run by `make demo`, or `python -m demo`; everything it makes is put in demo/output/.
"""

from __future__ import annotations

import sys
from pathlib import Path

from demo.stream import CRACKED_TOOTH, DemoError, Streamed, stream
from gear_dynamics.bag.channel import LogError
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.parameters.settings import SimSettings

FOLDER = Path('demo') / 'output'
DURATION = 24.0
"""How long it streams, in the time of the model [s]."""


def main() -> int:
    """Run the demo and return its exit code."""
    try:
        FOLDER.mkdir(parents=True, exist_ok=True)
        earlier = set(FOLDER.glob('gear_log_*'))
        streamed = stream(FOLDER, DURATION)
        logs = set(FOLDER.glob('gear_log_*')) - earlier
        if not logs:
            raise DemoError(f'the analyzer wrote no log; {FOLDER}/analyzer.txt says why')
        _report(logs.pop(), streamed)
    except KeyboardInterrupt:
        print(f'\nStopped. What was logged so far is in {FOLDER}/.', file=sys.stderr)
        return 130
    except (DemoError, LogError, OSError) as error:
        print(f'demo: {error}', file=sys.stderr)
        return 1
    return 0


def _report(log: Path, streamed: Streamed) -> None:
    # Imported now: loading SciPy and Matplotlib must not delay the start.
    from demo.figure import draw
    from demo.report import read_parts

    pair, settings, picture = GearPair(), SimSettings(), FOLDER / 'gear_dynamics.png'
    parts, gaps = read_parts(log, pair.pinion_teeth)
    teeth = f'{pair.pinion_teeth}/{pair.gear_teeth}'
    draw(
        picture,
        parts,
        CRACKED_TOOTH,
        f'A spur gear pair of {teeth} teeth under {settings.load_torque:g} N m, '
        f'streamed at {settings.sample_rate / 1000:g} kHz',
    )
    print(
        f'\nStreamed {streamed.blocks} blocks of {settings.block_size} samples, {DURATION:g} s, '
        f'at {streamed.real_time_factor:.3f} times real time.\n'
        f'The log has {gaps or "no"} gap{"" if gaps == 1 else "s"}.'
    )
    for part in parts[:2]:
        print(
            f'At {part.rpm:.0f} rpm the teeth mesh {part.expected:.1f} times a second; '
            f'the spectrum shows {part.found:.1f} Hz.'
        )
    print(
        f'Tooth {CRACKED_TOOTH} of the pinion was cracked, which is in contact from '
        f'{CRACKED_TOOTH} to {CRACKED_TOOTH + pair.derived.contact_ratio:.1f} teeth of its turn; '
        f'the synchronous average is greatest at {parts[2].loudest_place():.1f}.'
    )
    print(f'Log:     {log}\nPicture: {picture}')


if __name__ == '__main__':
    sys.exit(main())
