"""A log that is played once more is analysed whole, from its first block on."""

from streams import RIG, blocks, rotation, samples

from gear_dynamics.monitoring.monitor import Monitor
from gear_dynamics.monitoring.results import TableResult
from gear_dynamics.monitoring.thresholds import Thresholds
from gear_dynamics.parameters.settings import AnalyzerSettings


def spectra(results):
    return [
        (result.span.start_ns, result.rows.tobytes())
        for result in results
        if isinstance(result, TableResult) and result.name == 'spectrum'
    ]


def test_every_pass_gives_the_results_of_the_first_and_drops_nothing():
    stream = list(blocks(samples(rotation(1.5))))
    monitor = Monitor(AnalyzerSettings(), Thresholds({}))
    monitor.configure(RIG)
    found = []
    for _ in range(3):
        results = [each for stamp, rows in stream for each in monitor.add_block(stamp, rows)]
        found.append(spectra(results + monitor.begin_again('replay begins again')))
        monitor.configure(RIG)
    assert len(found[0]) == 2
    assert found[1:] == found[:1] * 2
    assert monitor.health.blocks == 3 * len(stream)
    assert not monitor.health.dropped
    assert monitor.health.restarts == {'replay begins again': 3}
