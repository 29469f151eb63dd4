"""Wrong input at the start: one line and exit code 2."""

from pathlib import Path

import pytest
import ros_support

CASES = [
    (['-p', 'speed:=6000.0'], ['speed', '6000', '0 to 5000 rad/s']),
    (['-p', 'sped:=60.0'], ['sped', 'nearest name is speed']),
    (['-p', 'gear_teeth:=59.5'], ['gear_teeth', '59.5', 'integer']),
    (['-p', 'pinion_teeth:=10'], ['10/59 teeth', 'interfere']),
    (['-p', 'monitor_rate:=3000'], ['monitor_rate', '3000', 'divide']),
    (['--params-file', 'none.yaml'], ['none.yaml', 'cannot be read']),
    (['--params-file', '{malformed}'], ['malformed.yaml', 'not YAML']),
    (['--params-file', '{unknown}'], ['unknown.yaml', 'half_backlsh', 'half_backlash']),
    (['-p', 'speed'], ['speed']),
    (['-p', 'speed:='], ['speed:=']),
    (['--no-such-option'], ['--no-such-option']),
]


def test_wrong_input_at_the_start_gives_a_line_and_exit_code_2(domain, tmp_path):
    files = {'malformed': 'gear_sim: [', 'unknown': '/**: {ros__parameters: {half_backlsh: 1e-4}}'}
    for name, text in files.items():
        (tmp_path / f'{name}.yaml').write_text(text)
    paths = {name: tmp_path / f'{name}.yaml' for name in files}
    for arguments, words in CASES:
        given = [each.format(**paths) for each in arguments]
        with ros_support.Process('gear_dynamics.nodes.sim', domain, arguments=given) as sim:
            assert sim.wait(60) == 2, given
            lines = sim.output.splitlines()
            assert len(lines) == 1, sim.output
            assert lines[0].startswith('gear_sim: ')
            assert all(word in lines[0] for word in words), lines[0]


def test_pair_that_cannot_be_integrated_gives_a_line_and_exit_code_1(domain):
    wrong = {'pinion_mass': 1e-10, 'pinion_inertia': 6e-4}
    with ros_support.Process('gear_dynamics.nodes.sim', domain, wrong) as sim:
        assert sim.wait(120) == 1
        *_, last = sim.output.splitlines()
        assert last.startswith('gear_sim: the integrator stopped at t = 0 s: the step size fell')
        assert 'check the parameters' in last
        assert 'Traceback' not in sim.output


def test_argument_that_is_not_for_ros_is_refused(domain):
    with ros_support.Process('gear_dynamics.nodes.sim', domain, command=['fast']) as sim:
        assert sim.wait(60) == 2
        assert 'fast is not an argument' in sim.output


def test_help_lists_the_parameters(domain):
    with ros_support.Process('gear_dynamics.nodes.sim', domain, command=['--help']) as sim:
        assert sim.wait(60) == 0
        assert 'real_time_factor (default 1.0)' in sim.output
        assert 'half_backlash (default 0.00015)' in sim.output


@pytest.mark.parametrize('library', ['numpy', 'rclpy', 'scipy'])
def test_signal_while_modules_load_ends_the_program_without_a_word(domain, library):
    with ros_support.Process('gear_dynamics', domain, command=['sim']) as sim:
        maps = Path('/proc', str(sim.pid), 'maps')
        ros_support.wait_until(lambda: f'/{library}/' in maps.read_text(), 60, library)
        assert sim.stop(timeout=20) == 0
        assert sim.output == ''


def test_file_for_another_node_is_refused(domain, tmp_path):
    other = tmp_path / 'other.yaml'
    other.write_text('gear_sym: {ros__parameters: {speed: 50.0}}')
    arguments = ['--params-file', str(other)]
    with ros_support.Process('gear_dynamics.nodes.sim', domain, arguments=arguments) as sim:
        assert sim.wait(60) == 2
        (line,) = sim.output.splitlines()
        assert 'no section is for /gear_sim; there are /gear_sym' in line


def test_first_compilation_is_announced_and_ends_at_a_signal(domain, tmp_path, monkeypatch):
    monkeypatch.setenv('NUMBA_CACHE_DIR', str(tmp_path))
    with ros_support.Process('gear_dynamics.nodes.sim', domain) as sim:
        sim.wait_for('compiling the model', 60)
        assert sim.stop(timeout=5) == 0
        assert 'Traceback' not in sim.output


def test_a_parameter_file_sets_the_rig(domain, client, tmp_path):
    from rclpy.qos import DurabilityPolicy, QoSProfile
    from std_msgs.msg import String

    from gear_dynamics.machine.configuration import Rig

    path = tmp_path / 'rig.yaml'
    path.write_text('/**: {ros__parameters: {pinion_teeth: 30, half_backlash: 1e-4, speed: 50}}')
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    texts = client.collect(String, 'rig/gear_pair/configuration', latched)
    arguments = ['--params-file', str(path), '-r', '__ns:=/rig']
    with ros_support.Process('gear_dynamics.nodes.sim', domain, arguments=arguments) as sim:
        ros_support.wait_until(lambda: texts, 120, 'the configuration')
        rig = Rig.from_text(texts[0].data)
        assert (rig.pinion_teeth, rig.half_backlash, rig.section_phase) == (30, 1e-4, 0.5)
        (result,) = client.set_parameters('rig/gear_sim', half_backlash=2e-4)
        assert result.successful
        ros_support.wait_until(lambda: len(texts) > 1, 10, 'the changed configuration')
        assert Rig.from_text(texts[1].data).half_backlash == pytest.approx(2e-4)
        assert sim.stop() == 0
