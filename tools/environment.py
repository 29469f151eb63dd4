"""Make a private Python environment for `make`, with one line of progress; standard library only.

Usage: environment.py FOLDER REQUIREMENT...
"""

import re
import subprocess
import sys
import time
from pathlib import Path

OLDEST = (3, 10)


def main(folder: str, *requirements: str) -> int:
    """Create the environment or mend it, install into it, and return an exit code."""
    if sys.version_info < OLDEST:
        return _fail(f'Python {sys.version.split()[0]} is too old: set PYTHON to 3.10 or later')
    if _follow(f'making {folder}', [sys.executable, '-m', 'venv', folder]):
        return _fail('on Debian and Ubuntu: apt install python3-venv')
    python = Path(folder) / 'bin' / 'python3'
    install = [str(python), '-m', 'pip', 'install', '--disable-pip-version-check', *requirements]
    if _follow(f'installing into {folder} (once)', install):
        return _fail(f'{folder} could not be set up')
    return 0


def _follow(what: str, command: list[str]) -> int:
    """Run a command, show what it is at in one line, and its output only if it fails."""
    start = time.monotonic()
    output = []
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    ) as process:
        assert process.stdout is not None
        for line in process.stdout:
            output.append(line)
            at = re.match(r'\s*(Collecting|Downloading|Building|Installing) (\S+)', line)
            if at and sys.stdout.isatty():
                _show(f'{what}: {time.monotonic() - start:.0f} s, {" ".join(at.groups())}')
    _show(f'{what}: {time.monotonic() - start:.0f} s\n')
    if process.returncode:
        sys.stderr.write(''.join(line for line in output if not line.startswith('WARNING')))
    return process.returncode


def _show(line: str) -> None:
    clear = '\r\x1b[K' if sys.stdout.isatty() else ''
    print(f'{clear}{line[:100]}', end='', flush=True)


def _fail(reason: str) -> int:
    print(reason, file=sys.stderr)
    return 1


if __name__ == '__main__':
    try:
        sys.exit(main(*sys.argv[1:]))
    except KeyboardInterrupt:
        sys.exit('\ninterrupted; the same command goes on from here')
