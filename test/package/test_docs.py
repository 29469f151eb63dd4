"""The documents: their links, their examples, and the messages that they quote."""

import os
import re
import subprocess
import sys

import pytest
from ros_support import ROOT

DOCS = ROOT / 'docs'
PAGES = sorted([ROOT / 'README.md', ROOT / 'CONTRIBUTING.md', *DOCS.glob('*.md')])
FRICTION, CRACK = 'tutorial_friction.md', 'tutorial_crack.md'

LINK = re.compile(r'\]\(([^)\s]+)\)')


def text_of(path):
    return path.read_text(encoding='utf-8')


def anchors(path):
    """Return the anchors that the headings of a page have, as GitHub and MkDocs make them."""
    headings = re.findall(r'^#+ (.+)$', re.sub(r'```.*?```', '', text_of(path), flags=re.S), re.M)
    return {re.sub(r'[^\w\- ]', '', each.lower()).strip().replace(' ', '-') for each in headings}


@pytest.mark.parametrize('page', PAGES, ids=lambda path: path.name)
def test_links_lead_to_files_and_headings_that_are_there(page):
    links = [each for each in LINK.findall(text_of(page)) if '://' not in each]
    for link in links:
        name, _, anchor = link.partition('#')
        target = page.parent / name if name else page
        assert target.exists(), link
        assert not anchor or anchor in anchors(target), link


def test_every_document_is_listed_in_the_readme_and_in_the_site():
    readme, site = text_of(ROOT / 'README.md'), text_of(ROOT / 'mkdocs.yml')
    for page in DOCS.glob('*.md'):
        assert f'(docs/{page.name})' in readme, page.name
        assert f': {page.name}\n' in site, page.name


def example(page, tmp_path):
    """Run the Python example of a tutorial; return what it prints."""
    (code,) = re.findall(r'```python\n(.*?)```', text_of(DOCS / page), re.DOTALL)
    code = code.replace("'config/", f"'{ROOT}/config/")
    done = subprocess.run(
        [sys.executable, '-c', code],
        cwd=tmp_path,
        env={**os.environ, 'PYTHONPATH': str(ROOT)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_friction_turns_chaos_into_period_4(tmp_path):
    told = re.findall(
        r'mu = ([\d.]+): (\d+) mesh cycles, (\d+) places', example(FRICTION, tmp_path)
    )
    (free, cycles, chaotic), (rubbing, _, periodic) = told
    assert (free, rubbing, cycles, periodic) == ('0.0', '0.05', '1238', '4')
    assert int(chaotic) > 300


def test_cracked_rig_is_logged_with_its_label_and_read_by_the_pipelines(tmp_path, capsys):
    label, samples = example(CRACK, tmp_path).splitlines()
    assert label == 'gear 17'
    assert samples == f"{8 * 51200} ('t', 'pinion_ax', 'pinion_ay')"
    section = text_of(DOCS / 'pipeline.md').partition('## Python without ROS')[2]
    names = {'path': tmp_path / 'cracked', 'file': next(tmp_path.glob('cracked/*.mcap'))}
    for code in re.findall(r'```python\n(.*?)```', section, re.DOTALL):
        exec(code, names)
    assert len(names['force']) == 8 * 51200
    assert len(names['events']) > 500  # a section each mesh cycle, 567 a second
    assert 'gear_pair: root_crack severity 0.5\n' in capsys.readouterr().out


PLACEHOLDER = re.compile(
    r'not judged: |\.\.\.|\b(?:N|NAME|FILE|NODE|sim|dashboard|aiohttp|[\d.]+)\b|\'[^\']*\''
)


def test_messages_of_the_troubleshooting_are_those_of_the_code():
    sources = [*(ROOT / 'gear_dynamics').rglob('*.py'), *(ROOT / 'launch').glob('*.py')]
    # A message that goes on in the next line of code is one.
    code = re.sub(r"'\n\s+f?'", '', '\n'.join(text_of(each) for each in sources))
    symptoms = [row.split(' | ')[0] for row in text_of(DOCS / 'troubleshooting.md').split('\n| ')]
    quoted = [quote for row in symptoms for quote in re.findall(r'"([^"]+)"', row)]
    assert len(quoted) > 25
    for quote in quoted:
        for part in PLACEHOLDER.split(quote):
            assert len(part) < 14 or part.strip(' :') in code, quote


@pytest.mark.slow
def test_site_is_built_without_a_warning(tmp_path):
    pytest.importorskip('mkdocstrings', reason='mkdocs is not installed')
    command = [sys.executable, '-m', 'mkdocs', 'build', '--strict', '--quiet', '-d', tmp_path]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    faults = (tmp_path / 'api' / 'faults.html').read_text(encoding='utf-8')
    assert 'gear_dynamics.model.faults.root_crack.RootCrack' in faults
    assert (tmp_path / 'index.html').is_file()
