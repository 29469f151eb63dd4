"""Systems whose exponents the literature gives, with their variations, as growth over steps."""

import numpy as np
from scipy.optimize import brentq

from gear_dynamics.integrator.variation import orthonormalise


def lorenz_growth(runs=200, time=60.0, step=0.01, between=50, sigma=10.0, rho=28.0, beta=8 / 3):
    """Growth of three variations over steps of between * step, rows of all runs one after another.

    x' = sigma (y - x), y' = x (rho - z) - y, z' = x y - beta z.
    """

    def rates(s, v):
        x, y, z = s.T
        ds = np.stack([sigma * (y - x), x * (rho - z) - y, x * y - beta * z], axis=1)
        a, b, c = v[..., 0], v[..., 1], v[..., 2]
        x, y, z = x[:, None], y[:, None], z[:, None]
        dv = [sigma * (b - a), (rho - z) * a - b - x * c, y * a + x * b - beta * c]
        return ds, np.stack(dv, axis=-1)

    s = np.random.default_rng(0).uniform([-5, -5, 20], [5, 5, 30], (runs, 3))
    v = np.repeat(np.eye(3)[None], runs, axis=0)
    rows = []
    for i in range(round(time / step)):
        k1 = rates(s, v)
        k2 = rates(*(y + step / 2 * k for y, k in zip((s, v), k1, strict=True)))
        k3 = rates(*(y + step / 2 * k for y, k in zip((s, v), k2, strict=True)))
        k4 = rates(*(y + step * k for y, k in zip((s, v), k3, strict=True)))
        s, v = (
            y + step / 6 * (a + 2 * b + 2 * c + d)
            for y, a, b, c, d in zip((s, v), k1, k2, k3, k4, strict=True)
        )
        if (i + 1) % between == 0:
            growth = np.zeros((runs, 3))
            for one, row in zip(v, growth, strict=True):
                orthonormalise(one, row)
            rows.append(growth)
    return np.array(rows)[10:].swapaxes(0, 1).reshape(-1, 3)


class ImpactOscillator:
    """x'' + x = cos(w t) for x < 0, with x' -> -r x' at x = 0: Shaw and Holmes 1983, limit case.

    Between impacts the solution is exact; at an impact the variations (x, v) jump by
    [[-r, 0], [(a+ + r a-) / v-, -r]], whose determinant is r^2.
    """

    def __init__(self, w, r):
        self.w, self.r = w, r
        self.forced = 1 / (1 - w**2)

    def at(self, t, t0, x0, v0):
        """Exact x and v at t of free motion from (t0, x0, v0)."""
        a = x0 - self.forced * np.cos(self.w * t0)
        b = v0 + self.forced * self.w * np.sin(self.w * t0)
        c, s = np.cos(t - t0), np.sin(t - t0)
        x = a * c + b * s + self.forced * np.cos(self.w * t)
        return x, -a * s + b * c - self.forced * self.w * np.sin(self.w * t)

    def growth(self, periods, skip):
        """Growth of two variations over each period of the drive, and impacts in each."""
        period = 2 * np.pi / self.w
        t, x, v = 0.0, -0.1, 0.0
        vectors = np.eye(2)
        rows, impacts = [], []
        for i in range(periods + skip):
            end, count = (i + 1) * period, 0
            while t < end:
                following = self._next_impact(t, x, v, end)
                stop = end if following is None else following
                c, s = np.cos(stop - t), np.sin(stop - t)
                vectors = vectors @ np.array([[c, s], [-s, c]]).T
                x, v = self.at(stop, t, x, v)
                t = stop
                if following is not None:
                    force = np.cos(self.w * t)
                    jump = [[-self.r, 0], [(force + self.r * force) / v, -self.r]]
                    vectors = vectors @ np.array(jump).T
                    x, v = 0.0, -self.r * v
                    count += 1
            row = np.zeros(2)
            vectors = np.ascontiguousarray(vectors)
            orthonormalise(vectors, row)
            rows.append(row)
            impacts.append(count)
        return np.array(rows)[skip:], np.array(impacts)[skip:]

    def _next_impact(self, t, x, v, end):
        grid = np.linspace(t + 1e-7, end, 60)
        values = self.at(grid, t, x, v)[0]
        above = np.flatnonzero(values > 0)
        if not above.size:
            return None
        i = above[0]
        if i == 0:
            return grid[0]
        return brentq(lambda s: self.at(s, t, x, v)[0], grid[i - 1], grid[i], xtol=1e-13)


class BacklashOscillator:
    """x'' + 2 zeta x' [|x| > 1] + f(x) = fm + fa w^2 cos(w t), f the backlash of half-width 1.

    Kahraman and Singh 1990, with the damping in contact only. Exact from one edge of the gap to
    the next, with no variation and no jump matrix.
    """

    def __init__(self, zeta, fm, fa, w):
        self.zeta, self.fm, self.fa, self.w = zeta, fm, fa, w
        self.beat = np.sqrt(1 - zeta**2)
        self.steady = fa * w**2 / (1 - w**2 + 2j * zeta * w)

    def at(self, t, t0, x0, v0, side):
        """Exact x and v at t of the motion from (t0, x0, v0) that stays at side -1, 0 or 1."""
        s, w = t - t0, self.w
        if side == 0:
            drift = v0 - self.fa * w * np.sin(w * t0)
            x = x0 + drift * s + self.fm * s**2 / 2 - self.fa * (np.cos(w * t) - np.cos(w * t0))
            return x, drift + self.fm * s + self.fa * w * np.sin(w * t)
        centre = self.fm + side
        begin, now = self.steady * np.exp(1j * w * t0), self.steady * np.exp(1j * w * t)
        a = x0 - centre - begin.real
        b = (v0 - (1j * w * begin).real + self.zeta * a) / self.beat
        c, d = np.cos(self.beat * s), np.sin(self.beat * s)
        decay = np.exp(-self.zeta * s)
        x = decay * (a * c + b * d)
        v = decay * self.beat * (b * c - a * d) - self.zeta * x
        return x + centre + now.real, v + (1j * w * now).real

    def over_period(self, i, x, v):
        """Return x and v after period i of the drive, from those at its beginning."""
        t, end = 2 * np.pi / self.w * i, 2 * np.pi / self.w * (i + 1)
        side = int(np.sign(x)) if abs(x) > 1 else 0
        while True:
            grid = np.linspace(t, end, 200)
            # The first point lies on an edge, where rounding decides the side.
            grid[0] = min(t + 1e-9, end)
            path = self.at(grid, t, x, v, side)[0]
            out = np.flatnonzero((np.where(np.abs(path) > 1, np.sign(path), 0)) != side)
            if not out.size or out[0] == 0:
                return self.at(end, t, x, v, side)
            edge = float(side or np.sign(path[out[0]]))
            arguments = (t, x, v, side)
            bracket = grid[out[0] - 1 : out[0] + 1]
            following = brentq(self._beyond, *bracket, (edge, *arguments), xtol=1e-14)
            v = self.at(following, *arguments)[1]
            t, x, side = following, edge, 0 if side else int(edge)

    def _beyond(self, t, edge, *arguments):
        return self.at(t, *arguments)[0] - edge

    def nearby_growth(self, periods, skip, distance=1e-7):
        """Growth of the distance of two motions over each period (Benettin and others 1976)."""
        x, v = 1 + self.fm, 0.0
        near_x, near_v = x + distance, v
        rows = []
        for i in range(skip + periods):
            x, v = self.over_period(i, x, v)
            near_x, near_v = self.over_period(i, near_x, near_v)
            apart = np.hypot(near_x - x, near_v - v)
            rows.append(np.log(apart / distance))
            near_x = x + (near_x - x) * distance / apart
            near_v = v + (near_v - v) * distance / apart
        return np.array(rows)[skip:]
