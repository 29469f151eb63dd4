"""Build the package for colcon (ament_python) and for pip alike."""

from pathlib import Path
from xml.etree import ElementTree

from setuptools import find_packages, setup

NAME = 'gear_dynamics'
SHARE = f'share/{NAME}'
# colcon build --symlink-install runs a link to this file, in a folder that lacks the rest.
ROOT = Path(__file__).resolve().parent
MANIFEST = ElementTree.parse(ROOT / 'package.xml')
DATA = ['pandas', 'pyarrow', 'h5py', 'npTDMS', 'pyuff']
LIVE = ['aiohttp', 'foxglove-sdk']
DOCS = ['mkdocs>=1.6', 'mkdocstrings[python]']
ROS = ['ros-jazzy-rclpy[fastrtps]', 'ros-jazzy-common-interfaces']


def files(pattern: str) -> list[str]:
    """Return the files that match, relative to the root, sorted."""
    return sorted(str(path.relative_to(ROOT)) for path in ROOT.glob(pattern) if path.is_file())


setup(
    name=NAME,
    version=MANIFEST.findtext('version'),
    description=' '.join(MANIFEST.findtext('description').split()),
    long_description=(ROOT / 'README.md').read_text(encoding='utf-8'),
    long_description_content_type='text/markdown',
    license='Apache-2.0',
    maintainer=MANIFEST.findtext('maintainer'),
    maintainer_email=MANIFEST.find('maintainer').get('email'),
    python_requires='>=3.10',
    packages=find_packages(include=[NAME, f'{NAME}.*']),
    package_data={
        NAME: ['py.typed'],
        f'{NAME}.web': ['static/*', 'static/panels/*', 'static/vendor/*'],
    },
    data_files=[
        ('share/ament_index/resource_index/packages', [f'resource/{NAME}']),
        (SHARE, ['package.xml']),
        (f'{SHARE}/config', files('config/*')),
        (f'{SHARE}/launch', files('launch/*.py')),
        (f'{SHARE}/urdf', files('urdf/*')),
        (f'lib/{NAME}', files('launchers/*')),
    ],
    entry_points={'console_scripts': ['gear-dynamics = gear_dynamics.__main__:main']},
    install_requires=[
        'numpy>=1.26',
        'scipy>=1.11',
        'numba>=0.58',
        'mcap>=1.2.2',
        'rosbags',
        'PyYAML',
        'matplotlib',
        'tqdm',
    ],
    extras_require={
        'ros': ROS,
        'data': DATA,
        'cluster': ['dask[distributed]'],
        'live': LIVE,
        'docs': DOCS,
        'test': [
            *DATA,
            *DOCS,
            *LIVE,
            'colcon-common-extensions',
            'dask[distributed]',
            'hypothesis',
            'mcap-ros2-support',
            'mypy',
            'pytest',
            'pytest-cov',
            'pytest-timeout',
            'pytest-xdist',
            'ruff',
            'scikit-learn',
            'selenium',
            'scikit-fem',
            'types-PyYAML',
            'types-tqdm',
        ],
    },
    zip_safe=False,
)
