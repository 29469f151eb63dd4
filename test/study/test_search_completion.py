import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]


def test_search_for_a_completion_runs(tmp_path):
    few = [f'--{name}=1' for name in ('generations', 'members', 'verified')]
    done = subprocess.run(
        [sys.executable, ROOT / 'tools' / 'search_completion.py', *few],
        cwd=tmp_path,
        env={'PYTHONPATH': str(ROOT)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    assert ' draws showed chaotic, chaotic, period-4; of the nearest ' in done.stdout
    # The preset comes last, and shows the sequence that it was searched for.
    assert done.stdout.count('3 of 3 chaotic') >= 2
    assert '3 of 3 period-4' in done.stdout
    assert not list(tmp_path.iterdir())
