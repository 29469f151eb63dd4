"""One tooth on its gear body by plane-strain finite elements, healthy or with a root crack.

A reference that shares nothing with the formulas but the outline of the tooth. The body is a ring
that is held at its bore; its other teeth are left out, as in Sainsot's ring. The force acts at a
point of the flank, along the normal, and the deflection is taken where the line of action cuts the
tooth's centre line, so that the contact's own deformation stays out of it.

Usage: python test/model/mesh/finite_elements.py      prints the table of docs/faults.md
"""

from __future__ import annotations

import functools
import math
from typing import NamedTuple

import numpy as np
import skfem
from matplotlib.path import Path
from scipy.spatial import Delaunay, cKDTree
from skfem.helpers import ddot, eye, sym_grad, trace

from gear_dynamics.model.faults import SpeedAndLoad
from gear_dynamics.model.faults.root_crack import RootCrack
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.mesh.path import PathOfContact
from gear_dynamics.model.mesh.potential_energy import PotentialEnergy

CRACKED = GearPair(
    pinion_teeth=25,
    gear_teeth=30,
    face_width=0.02,
    pinion_bore=0.02,
    gear_bore=0.025,
    mesh_stiffness='potential_energy',
)
QUIET = GearPair(pinion_bore=0.03, gear_bore=0.05, mesh_stiffness='potential_energy')
DEPTHS = 0.5e-3, 1e-3, 1.5e-3, 2e-3


def flank(tooth, spacing):
    """Return the right half of the tooth from root to tip, as points about `spacing` apart."""
    gamma = np.linspace(math.pi / 2, tooth.pressure_angle, 400)
    tip = math.tan(math.acos(tooth.base_radius / tooth.tip_radius))
    roll = np.linspace(tooth.start_of_involute, tip, 400)[1:]
    x, y = tooth.fillet(gamma)[:2]
    _, x_flank, y_flank, _ = tooth.involute(roll)
    line = np.stack([np.append(x, x_flank), np.append(y, y_flank)], axis=1)
    return resampled(line, spacing)


def resampled(line, spacing):
    """Return points on a polyline, evenly spaced, with both ends."""
    along = np.append(0.0, np.cumsum(np.hypot(*np.diff(line, axis=0).T)))
    count = max(round(along[-1] / spacing), 1) + 1
    at = np.linspace(0.0, along[-1], count)
    return np.stack([np.interp(at, along, line[:, 0]), np.interp(at, along, line[:, 1])], axis=1)


def outline(tooth, spacing, crack=0.0, angle_deg=70.0):
    """Return the tooth on a wide part of the root circle, the crack a slit in its right fillet."""
    right = flank(tooth, spacing)
    root, half = right[0], math.atan2(right[0, 0], right[0, 1])
    turns = np.cumsum(spacing * 1.08 ** np.arange(200)) / tooth.root_radius
    aside = half + turns[turns < math.pi - half - 0.15]
    arc = tooth.root_radius * np.stack([np.sin(aside), np.cos(aside)], axis=1)[::-1]
    slit = np.zeros((0, 2))
    if crack > 0:
        a = math.radians(angle_deg)
        inward = np.array([-math.sin(a), -math.cos(a)])
        across = np.array([-inward[1], inward[0]]) * 1e-3 * spacing
        steps = np.linspace(0.0, crack, max(int(crack / spacing * 2), 2) + 1)[1:-1, None]
        down, tip = root + steps * inward, root + crack * inward
        slit = np.concatenate([down - across, [tip], (down + across)[::-1]])
        if np.dot(across, right[1] - root) < 0:
            slit = slit[::-1]
    # From the far right along the root circle, into the crack, up the flank, and mirrored down.
    side = np.concatenate([arc, [root], slit, right[1:]])
    top = np.linspace(right[-1], right[-1] * [-1, 1], 7)[1:-1]
    mirror = np.concatenate([right[::-1], arc[::-1]]) * [-1, 1]
    return np.concatenate([side, top, mirror])


def mesh_of(tooth, bore, spacing, crack=0.0, angle_deg=70.0):
    """Return points (n, 2) and triangles (m, 3) of the tooth and its ring."""
    edge = outline(tooth, spacing, crack, angle_deg)
    count = 120
    turn = np.linspace(-np.pi, np.pi, count, endpoint=False)
    inner = bore / 2 * np.stack([np.sin(turn), np.cos(turn)], axis=1)
    rng = np.random.default_rng(0)
    middle = np.array([0.0, tooth.root_radius])

    def wanted(points):
        away = np.hypot(*(points - middle).T)
        return np.maximum(spacing, 0.16 * (away - 2.2 * tooth.module))

    inside = [inner]
    tree_points = np.concatenate([edge, inner])
    # Points of a jittered grid at every size, kept where the size is the wanted one.
    size = spacing
    while size < tooth.tip_radius:
        reach = min(tooth.tip_radius, 2.2 * tooth.module + 2 * size / 0.16)
        low, high = middle - reach, middle + reach
        x, y = np.meshgrid(np.arange(low[0], high[0], size), np.arange(low[1], high[1], size))
        x[1::2] += size / 2
        grid = np.stack([x.ravel(), y.ravel()], axis=1)
        grid += rng.uniform(-0.05, 0.05, grid.shape) * size
        near = wanted(grid)
        grid = grid[(near >= size) & (near < 1.6 * size)]
        grid = grid[contains(edge, grid) & (np.hypot(*grid.T) > bore / 2 + 0.3 * size)]
        far = cKDTree(tree_points).query(grid)[0] > 0.55 * size
        inside.append(grid[far])
        tree_points = np.concatenate([tree_points, grid[far]])
        size *= 1.6
    points = np.concatenate([edge, *inside])
    triangles = Delaunay(points).simplices
    centre = points[triangles].mean(axis=1)
    kept = contains(edge, centre) & (np.hypot(*centre.T) > bore / 2 * math.cos(np.pi / count))
    corners = points[triangles]
    (x1, y1), (x2, y2) = ((corners[:, k] - corners[:, 0]).T for k in (1, 2))
    area = 0.5 * (x1 * y2 - x2 * y1)
    kept &= abs(area) > 1e-9 * spacing**2
    return points, triangles[kept]


def contains(polygon, points):
    """Return which points are inside a polygon, by the number of its edges to their right."""
    return Path(polygon).contains_points(points)


class Deflection(NamedTuple):
    """Compliance of tooth and body [m/N] under a force at a roll angle of the flank."""

    roll: float
    compliance: float


def deflection(tooth, bore, place, material, spacing=None, crack=0.0, angle_deg=70.0):
    """Return the compliance under a force near a roll angle.

    Parameters
    ----------
    tooth : Tooth
    bore : float
        Diameter [m].
    place : float
        Roll angle; the point of the outline next to it is loaded.
    material : tuple of float
        Face width, Young's modulus, Poisson's ratio.
    spacing : float
        Size of the elements in the tooth [m]; a tenth of the module by default, which is within
        0.5 % of half that size.
    crack, angle_deg : float
        Depth [m] and angle to the tooth's centre line.
    """
    width, modulus, poisson = material
    points, triangles = mesh_of(tooth, bore, spacing or tooth.module / 10, crack, angle_deg)
    used = np.unique(triangles)
    renumbered = np.zeros(len(points), int)
    renumbered[used] = np.arange(used.size)
    mesh = skfem.MeshTri(points[used].T.copy(), renumbered[triangles].T.copy())
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementTriP2()))
    shear = modulus / (2 * (1 + poisson))
    lame = modulus * poisson / ((1 + poisson) * (1 - 2 * poisson))

    @skfem.BilinearForm
    def stiffness(u, v, w):
        strain = sym_grad(u)
        stress = 2 * shear * strain + lame * eye(trace(strain), 2)
        return ddot(stress, sym_grad(v))

    matrix = stiffness.assemble(basis)
    held = basis.get_dofs(lambda x: np.hypot(x[0], x[1]) < bore / 2 * 1.001).all()
    _, x_wanted, y_wanted, _ = tooth.involute(np.array([place]))
    away = np.hypot(mesh.p[0] - x_wanted, mesh.p[1] - y_wanted)
    node = int(np.argmin(away))
    roll = math.sqrt((np.hypot(*mesh.p[:, node]) / tooth.base_radius) ** 2 - 1)
    tau = float(roll - tooth.half_base_angle)
    towards = np.array([-math.cos(tau), -math.sin(tau)])
    force = np.zeros(basis.N)
    force[basis.nodal_dofs[:, node]] = towards / width
    moved = skfem.solve(*skfem.condense(matrix, force, D=held))
    x, y = mesh.p[:, node]
    centre = np.array([[0.0], [y - x * math.tan(tau)]])
    found = basis.probes(centre) @ moved
    return Deflection(roll, float(found.reshape(2, -1)[:, 0] @ towards))


@functools.lru_cache
def pair_at_pitch_point(pair, crack=0.0):
    """Return the single stiffness at the pitch point with teeth and bodies by finite elements.

    The Hertzian contact is that of `PotentialEnergy`; the crack is the pinion's.
    """
    path = PathOfContact.of(pair)
    material = pair.face_width, pair.youngs_modulus, pair.poissons_ratio
    roll = math.tan(math.radians(pair.pressure_angle_deg))
    total = 1 / PotentialEnergy.of(pair, body_once=True).contact_stiffness
    for tooth, bore, depth in (
        (path.pinion, pair.pinion_bore, crack),
        (path.gear, pair.gear_bore, 0.0),
    ):
        total += deflection(tooth, bore, roll, material, crack=depth).compliance
    return 1 / total


def formula_with_crack(pair, depth):
    """Return the single stiffness at the pitch point with a crack by the package."""
    crack = RootCrack('pinion', tooth=0, severity=1.0, deepest=depth)
    (term,) = crack.ports(pair, SpeedAndLoad())
    at = pair.derived.approach_length
    piece = int(np.searchsorted(term.edges, at)) - 1
    x = (at - term.edges[piece]) / (term.edges[piece + 1] - term.edges[piece])
    relative = np.polynomial.polynomial.polyval(x, term.stiffness[piece])
    return pair.derived.single_stiffness * (1 + relative)


def main():
    """Print the tables of docs/faults.md."""
    print('| pair | finite elements | potential energy | ISO 6336 |\n|---|---|---|---|')
    for pair in (QUIET, CRACKED):
        reference, d = pair_at_pitch_point(pair), pair.derived
        cells = [f'{reference / 1e6:.0f} N/um']
        for k in (d.potential_energy_stiffness, d.iso_6336_stiffness):
            cells.append(f'{k / 1e6:.0f} N/um ({k / reference - 1:+.0%})')
        width = pair.face_width * 1e3
        name = f'{pair.pinion_teeth}/{pair.gear_teeth} teeth, {width:g} mm wide'
        print(f'| {name} | {" | ".join(cells)} |')
    print('\n| crack | loss by finite elements | by the fault |\n|---|---|---|')
    whole, d = pair_at_pitch_point(CRACKED), CRACKED.derived
    for depth in DEPTHS:
        loss = 1 - pair_at_pitch_point(CRACKED, depth) / whole
        formula = 1 - formula_with_crack(CRACKED, depth) / d.single_stiffness
        print(f'| {depth * 1e3:g} mm | {loss:.1%} | {formula:.1%} |')


if __name__ == '__main__':
    main()
