import numpy as np
import pytest

from gear_dynamics.study.initial import scattered_states
from gear_dynamics.study.lyapunov_table import spectrum_task
from gear_dynamics.study.operation import friction_chaos
from gear_dynamics.study.tasks import Runner, chunks, fingerprint

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


def test_a_part_cut_short_while_written_is_not_taken_for_a_result(tmp_path):
    CALLS.clear()
    Runner(tmp_path).run(square, [{'x': 7}])
    (part,) = tmp_path.glob('*.npz')
    part.rename(part.with_suffix('.unfinished'))
    assert int(Runner(tmp_path).run(square, [{'x': 7}])[0]['square']) == 49
    assert CALLS == [7, 7]


def test_parts_go_when_the_study_is_written(tmp_path):
    runner = Runner(tmp_path / 'parts')
    runner.run(square, [{'x': 1}])
    runner.forget()
    assert not (tmp_path / 'parts').exists()


def test_fingerprints_tell_arguments_apart():
    operation = friction_chaos()
    same = {'operation': operation, 'states': np.zeros(3)}
    others = [
        {'operation': operation.with_value('w', 1.0), 'states': np.zeros(3)},
        {'operation': operation.with_value('friction_coefficient', 0.0), 'states': np.zeros(3)},
        {'operation': operation, 'states': np.zeros(3, np.float32)},
        {'operation': operation, 'states': np.array([0, 0, 1e-300])},
    ]
    assert fingerprint(same) == fingerprint({'states': np.zeros(3), 'operation': friction_chaos()})
    assert len({fingerprint(each) for each in [same, *others]}) == 5


def test_chunks_cover_all():
    assert [list(range(10))[part] for part in chunks(10, 4)] == [[0, 1, 2, 3], [4, 5, 6, 7], [8, 9]]


def test_a_result_is_the_same_on_a_cluster():
    distributed = pytest.importorskip('distributed', reason='dask is not installed')
    operation = friction_chaos()
    arguments = [
        {
            'operation': operation,
            'states': scattered_states(operation, 2),
            'transient': 10,
            'cycles': cycles,
            'nearby': 10,
        }
        for cycles in (30, 40)
    ]
    here = Runner().run(spectrum_task, arguments)
    # Workers in this process: the compiled kernels are at hand.
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None
    ) as cluster:
        runner = Runner(cluster=cluster.scheduler_address)
        there = runner.run(spectrum_task, arguments)
        runner.close()
    for one, other in zip(here, there, strict=True):
        for name in one:
            assert np.array_equal(one[name], other[name]), name
