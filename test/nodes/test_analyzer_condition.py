"""What the analyzer judges, learns and acknowledges, seen from outside."""

import ros_support
from monitoring.streams import blocks, rotation, samples
from nodes.test_analyzer_faults import ANALYZER, encoded, feed, latest, listen, values


def test_levels_baselines_and_services(domain, client, tmp_path):
    from std_srvs.srv import Trigger

    limits = tmp_path / 'limits.yaml'
    limits.write_text(
        'limits: {mesh_force/rms: {warn: 1.0e-6}, delta/rms: {warn: 3, relative: true}}'
    )
    baseline = tmp_path / 'baseline.json'
    parameters = {
        'log': False,
        'thresholds': limits,
        'baseline': baseline,
        'learn_spans': 2,
        'statistics_duration': 0.5,
    }
    diagnostics, _ = listen(client)
    with ros_support.Process(ANALYZER, domain, parameters) as analyzer:
        stream = list(blocks(samples(rotation(4.0))))
        feed(client, diagnostics, encoded(stream))

        def judged():
            status = latest(diagnostics, 'gear_analyzer: condition')
            return status and values(status).get('bins_learned') == '1'

        ros_support.wait_until(judged, 60, 'a learned bin')
        found = values(latest(diagnostics, 'gear_analyzer: condition'))
        assert int(found['judged']) > 0
        assert int(found['not judged: the operating state is settling']) > 0
        # Four seconds came at once: the last block waited for the others, by the events executor.
        stream_status = values(latest(diagnostics, 'gear_analyzer: stream'))
        assert float(stream_status['behind [s]']) > 0
        for service in ('learn', 'acknowledge'):
            answer = client.call(Trigger, f'gear_analyzer/{service}', Trigger.Request())
            assert answer.success, answer.message
        assert analyzer.stop() == 0
        told = [line for line in analyzer.output.splitlines() if 'mesh_force/rms: OK' in line]
    assert len(told) == 1
    assert 'OK -> WARN at 0.000707' in told[0]  # a cosine of 1e-3
    assert baseline.exists()
