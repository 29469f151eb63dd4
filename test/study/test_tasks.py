import errno
from pathlib import Path

import numpy as np
import pytest

from gear_dynamics.study import cache
from gear_dynamics.study.cache import fingerprint
from gear_dynamics.study.operating_point import friction_chaos
from gear_dynamics.study.tasks import Runner, chunks
from gear_dynamics.versions import versions

CALLS = []


def square(x):
    CALLS.append(x)
    return {'square': np.array(x * x)}


def stops_at_three(x):
    if x == 3:
        raise KeyboardInterrupt
    return square(x)


stops_at_three.__name__ = 'square'


def test_an_interrupted_study_goes_on_from_what_it_had(tmp_path):
    CALLS.clear()
    arguments = [{'x': x} for x in range(5)]
    with pytest.raises(KeyboardInterrupt):
        Runner(tmp_path).run(stops_at_three, arguments)
    assert CALLS == [0, 1, 2]
    results = Runner(tmp_path).run(square, arguments)
    assert CALLS == [0, 1, 2, 3, 4]
    assert [int(each['square']) for each in results] == [0, 1, 4, 9, 16]


def _damages(content):
    middle = len(content) // 2
    flipped = bytes([content[middle] ^ 1])
    return [b'', content[:20], content[:-1], content[:middle] + flipped + content[middle + 1 :]]


@pytest.mark.parametrize('damage', range(4))
def test_a_damaged_part_is_computed_again_and_the_others_are_not(tmp_path, damage):
    arguments = [{'x': x} for x in range(3)]
    Runner(tmp_path).run(square, arguments)
    part = sorted(tmp_path.glob('*.part'))[damage % 3]
    part.write_bytes(_damages(part.read_bytes())[damage])
    CALLS.clear()
    runner = Runner(tmp_path)
    assert [int(each['square']) for each in runner.run(square, arguments)] == [0, 1, 4]
    assert len(CALLS) == runner.computed == 1
    assert runner.taken == 2


def test_results_of_other_code_are_not_taken(tmp_path, monkeypatch):
    other = {**cache.code(), 'sources': 'other'}
    with monkeypatch.context() as patch:
        patch.setattr(cache, 'code', lambda: other)
        Runner(tmp_path).run(square, [{'x': 7}])
    CALLS.clear()
    runner = Runner(tmp_path)
    runner.run(square, [{'x': 7}])
    assert CALLS == [7]
    assert len(list(tmp_path.iterdir())) == 2
    runner.forget()
    assert not tmp_path.exists()


def test_code_is_told_by_versions_and_sources():
    assert cache.code()['numpy'] == np.__version__
    assert set(cache.code()) == {*versions(), 'sources'}


def test_a_disk_that_is_full_keeps_what_was_there(tmp_path, monkeypatch):
    arguments = [{'x': x} for x in range(3)]
    Runner(tmp_path).run(square, arguments[:2])
    whole = Path.write_bytes

    def write_half(path, content):
        whole(path, content[: len(content) // 2])
        raise OSError(errno.ENOSPC, 'No space left on device')

    monkeypatch.setattr(Path, 'write_bytes', write_half)
    with pytest.raises(OSError, match='No space'):
        Runner(tmp_path).run(square, arguments)
    assert len(list(tmp_path.iterdir())) == 2


def test_parts_go_when_the_study_is_written(tmp_path):
    runner = Runner(tmp_path / 'parts')
    runner.run(square, [{'x': 1}])
    runner.forget()
    assert not (tmp_path / 'parts').exists()


def test_parts_of_another_study_stay(tmp_path):
    Runner(tmp_path).run(square, [{'x': 1}])
    runner = Runner(tmp_path)
    runner.run(square, [{'x': 2}])
    runner.forget()
    runner = Runner(tmp_path)
    runner.run(square, [{'x': 1}, {'x': 2}])
    assert (runner.taken, runner.computed) == (1, 1)


def test_progress_counts_the_tasks_of_several_runs_and_those_found_before(tmp_path, capsys):
    arguments = [{'x': x} for x in range(4)]
    Runner(tmp_path).run(square, arguments[:2])
    runner = Runner(tmp_path, progress=True)
    with runner.progress(4, 'squares'):
        runner.run(square, arguments[:3], 'three')
        runner.run(square, arguments[3:], 'one')
    last = capsys.readouterr().err.rstrip().rsplit('\r', 1)[-1]
    assert last.startswith('squares: 100%')
    assert ' 4/4 ' in last


def test_progress_is_shown_for_a_label_alone(capsys):
    Runner(progress=True).run(square, [{'x': 1}])
    assert capsys.readouterr().err == ''
    Runner(progress=True).run(square, [{'x': 1}], 'square')
    assert 'square: 100%' in capsys.readouterr().err


def test_fingerprints_tell_arguments_apart():
    operation = friction_chaos()
    same = {'point': operation, 'states': np.zeros(3)}
    others = [
        {'point': operation.with_value('w', 1.0), 'states': np.zeros(3)},
        {'point': operation.with_value('friction_coefficient', 0.0), 'states': np.zeros(3)},
        {'point': operation, 'states': np.zeros(3, np.float32)},
        {'point': operation, 'states': np.array([0, 0, 1e-300])},
    ]
    assert fingerprint(same) == fingerprint({'states': np.zeros(3), 'point': friction_chaos()})
    assert len({fingerprint(each) for each in [same, *others]}) == 5


def test_chunks_cover_all():
    assert [list(range(10))[part] for part in chunks(10, 4)] == [[0, 1, 2, 3], [4, 5, 6, 7], [8, 9]]
