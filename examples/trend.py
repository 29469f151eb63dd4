"""Go through a folder of recordings of one machine and draw the trend of an indicator.

Usage: python trend.py FOLDER MACHINE_FILE CHANNEL/NAME [FIGURE.png]
"""

import sys

import matplotlib.pyplot as plt

import gear_dynamics as gd


def trend(folder, machine_file, column, figure='trend.png'):
    """Analyse every recording, and draw a column against the time of the recordings."""
    # The machine file says `files: series`: each file has its own time stamp.
    table = gd.analyse(folder, machine_file)
    unit = table.attrs['units'][column]
    axes = table.plot('t', column, marker='.', legend=False)
    axes.set(xlabel='time [s]', ylabel=f'{column} [{unit}]')
    plt.savefig(figure)
    return table


if __name__ == '__main__':
    trend(*sys.argv[1:])
