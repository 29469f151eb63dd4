"""The gear pair's equations in plain Python: what the model must equal.

Written from the equations of docs/model.md alone, in the coordinates x1, y1, x2, y2, th1, th2 that
they are stated in, and sharing nothing with the model but the parameters.
"""

import dataclasses
import itertools
import math

import numpy as np

COLUMNS = (
    'pinion_ax',
    'pinion_ay',
    'gear_ax',
    'gear_ay',
    'mesh_force',
    'friction_force',
    'delta',
    'delta_dot',
    'pinion_angle',
    'gear_angle',
    'speed',
    'load_torque',
)


UNIT_RAMP = (1.0, 0.0)
QUANTITIES = ('stiffness', 'damping', 'error', 'friction')


class Ramp:
    """A command that is linear between given instants and constant outside of them."""

    def __init__(self, times, values):
        self.times, self.values = [float(t) for t in times], [float(v) for v in values]

    def __call__(self, t):
        return float(np.interp(t, self.times, self.values))

    def rate(self, t):
        """Return the rate of change just after t."""
        for t0, t1, v0, v1 in zip(
            self.times, self.times[1:], self.values, self.values[1:], strict=False
        ):
            if t0 <= t < t1:
                return (v1 - v0) / (t1 - t0)
        return 0.0

    def integral(self, t):
        """Return the integral from 0 to t."""
        knots = [0.0, *[s for s in self.times if 0 < s < t], t]
        return sum((b - a) * (self(a) + self(b)) / 2 for a, b in itertools.pairwise(knots))


@dataclasses.dataclass
class Pair:
    """A tooth pair in contact during one interval between events."""

    number: int  # in the order of engagement
    sliding: int  # lambda
    pieces: list  # begin and end, coefficients of stiffness, damping, error, friction; loss
    contact: int = 1  # drive flank 1, gap 0, back flank -1


def piece_at(begin, end, coefficients, at):
    """Return a polynomial of the place between begin and end, and its slope."""
    x = (at - begin) / (end - begin)
    value = slope = 0.0
    for coefficient in reversed(coefficients):
        slope = slope * x + value
        value = value * x + float(coefficient)
    return value, slope / (end - begin)


class Equations:
    """The equations of a gear pair under commands.

    Parameters
    ----------
    pair : GearPair
    speed, torque : float or Ramp
    ports : iterable of terms of model.ports
    drive : bool
        False for the reduced form: T1 = T2 z1 / z2 at constant speed.
    strength : Ramp, optional
        By which all terms are multiplied.
    """

    def __init__(self, pair, speed, torque, ports=(), drive=True, strength=None):
        self.pair, self.drive, self.ports = pair, drive, list(ports)
        self.strength = strength
        self.near = 0.0  # an instant within the interval: tells which pieces hold at its ends
        self.speed = speed if isinstance(speed, Ramp) else Ramp([0.0], [speed])
        self.torque = torque if isinstance(torque, Ramp) else Ramp([0.0], [torque])
        self._geometry()

    def _geometry(self):
        p = self.pair
        a = math.radians(p.pressure_angle_deg)
        r1, r2 = p.module * p.pinion_teeth / 2, p.module * p.gear_teeth / 2
        self.rb1, self.rb2 = r1 * math.cos(a), r2 * math.cos(a)
        self.pb = math.pi * p.module * math.cos(a)
        self.l1 = math.sqrt((r2 + p.module) ** 2 - self.rb2**2) - r2 * math.sin(a)
        recess = math.sqrt((r1 + p.module) ** 2 - self.rb1**2) - r1 * math.sin(a)
        self.eps = (self.l1 + recess) / self.pb
        self.arm0 = r1 * math.sin(a) - self.l1
        self.arm_sum = (self.rb1 + self.rb2) * math.tan(a)
        self.m1 = p.pinion_mass or p.density * math.pi * r1**2 * p.face_width
        self.m2 = p.gear_mass or p.density * math.pi * r2**2 * p.face_width
        self.i1 = p.pinion_inertia or self.m1 * r1**2 / 2
        self.i2 = p.gear_inertia or self.m2 * r2**2 / 2
        me = 1 / (self.rb1**2 / self.i1 + self.rb2**2 / self.i2)
        self.k, self.wn = p.tooth_pair_stiffness, math.sqrt(p.tooth_pair_stiffness / me)
        self.c = 2 * p.mesh_damping_ratio * math.sqrt(self.k * me)
        self.k1, self.k2 = p.pinion_support_stiffness, p.gear_support_stiffness
        self.c1 = 2 * p.support_damping_ratio * math.sqrt(self.k1 * self.m1)
        self.c2 = 2 * p.support_damping_ratio * math.sqrt(self.k2 * self.m2)
        self.b, self.mu = p.half_backlash, p.friction_coefficient
        wd = 2 * math.pi * p.drive_frequency
        self.it = self.i1 + self.i2 * (self.rb1 / self.rb2) ** 2
        self.kd = wd**2 * self.it
        self.cd = 2 * p.drive_damping_ratio * wd * self.it
        self.ki = self.kd * wd / 5

    def phase(self, t):
        """Mesh phase in cycles."""
        return self.pair.pinion_teeth * self.speed.integral(t) / (2 * math.pi)

    def _follow_commands(self, begin):
        """Take the commands from `begin` on, where they are linear up to the next boundary."""
        self.begin, self.turned_before = begin, self.speed.integral(begin)
        self.speed_before, self.accel = self.speed(begin), self.speed.rate(begin)
        self.torque_before, self.torque_rate = self.torque(begin), self.torque.rate(begin)

    def rigid_motion(self, t):
        """Return Theta1 and Omega."""
        since = t - self.begin
        speed = self.speed_before + self.accel * since
        return self.turned_before + since * (self.speed_before + speed) / 2, speed

    def load(self, t):
        """Return T2."""
        return self.torque_before + self.torque_rate * (t - self.begin)

    def error(self, t):
        """Transmission error e and its rate."""
        p = self.pair
        turned, speed = self.rigid_motion(t)
        angle = p.pinion_teeth * turned + p.transmission_error_phase
        amplitude = p.transmission_error_amplitude
        return (
            amplitude * math.sin(angle),
            amplitude * p.pinion_teeth * speed * math.cos(angle),
        )

    def fade(self, t):
        """Return the strength of the terms and its rate."""
        if self.strength is None:
            return UNIT_RAMP
        return self.strength(t), self.strength.rate(self.near)

    def argument(self, name, t):
        """Return what a term is a function of, with its first and second derivatives."""
        if name == 'time':
            return t, 1.0, 0.0
        turned, speed = self.rigid_motion(t)
        factor = {'pinion': 1.0, 'mesh': self.pair.pinion_teeth}.get(
            name, self.pair.pinion_teeth / self.pair.gear_teeth
        ) / (2 * math.pi)
        return factor * turned, factor * speed, factor * self.accel

    def term_at(self, term, t):
        """Return a term of a signal and its rate."""
        if hasattr(term, 'value'):
            return term.value, 0.0
        if hasattr(term, 'order'):
            at, rate, curvature = self.argument(term.argument, t)
            turn = 2 * math.pi * term.order
            angle, w, a = turn * at + term.phase, turn * rate, turn * curvature
            sine, cosine = math.sin(angle), math.cos(angle)
            derivatives = (
                sine,
                cosine * w,
                cosine * a - sine * w**2,
                -cosine * w**3 - 3 * sine * w * a,
            )
            n = term.derivative
            return term.amplitude * derivatives[n], term.amplitude * derivatives[n + 1]
        knots = term.knots
        period = knots[-1] - knots[0]
        near = self.argument(term.argument, self.near)[0]
        lap = math.floor((near - knots[0]) / period)
        j = int(np.searchsorted(knots, near - lap * period, side='right')) - 1
        at, rate, _ = self.argument(term.argument, t)
        value, slope = piece_at(knots[j], knots[j + 1], term.coefficients[j], at - lap * period)
        return value, slope * rate

    def signal(self, name, t):
        """Return what the terms add to a signal, and its rate."""
        value = rate = 0.0
        strength, fading = self.fade(t)
        for term in self.ports:
            if getattr(term, 'signal', None) == name:
                v, r = self.term_at(term, t)
                value, rate = value + strength * v, rate + strength * r + fading * v
        return value, rate

    def half_backlash(self, t):
        """Return b and its rate."""
        value, rate = self.signal('half_backlash', t)
        return self.b + value, rate

    def pairs_at(self, phase):
        """Return the tooth pairs in contact at a mesh phase that is not an event's."""
        cycle = math.floor(phase)
        found = []
        for ahead in (0, 1):
            s = (phase - cycle + ahead) * self.pb
            if s > self.eps * self.pb:
                continue
            number = cycle - ahead
            teeth = {
                'pinion': number % self.pair.pinion_teeth,
                'gear': number % self.pair.gear_teeth,
            }
            pieces = [
                (a, b, [getattr(t, name)[j] for name in QUANTITIES], t.loss)
                for t in self.ports
                if hasattr(t, 'edges') and (t.tooth is None or t.tooth == teeth[t.wheel])
                for j, (a, b) in enumerate(itertools.pairwise(t.edges))
                if a <= s <= b
            ]
            found.append(Pair(number, 1 if s < self.l1 else -1, pieces))
        return found

    def pair_terms(self, pair, t):
        """Return s, k_i, c_i, mu_i, e_i and e_i' of a tooth pair."""
        turned, speed = self.rigid_motion(t)
        s = (self.pair.pinion_teeth * turned / (2 * math.pi) - pair.number) * self.pb
        s_dot = self.pb * self.pair.pinion_teeth / (2 * math.pi) * speed
        k, c, e, rate, left = self.k, self.c, 0.0, 0.0, 1.0
        mu = self.mu + self.signal('friction', t)[0]
        strength, fading = self.fade(t)
        for begin, end, (stiffness, damping, error, friction), loss in pair.pieces:
            left *= 1 - strength * loss
            k += strength * self.k * piece_at(begin, end, stiffness, s)[0]
            c += strength * self.c * piece_at(begin, end, damping, s)[0]
            mu += strength * piece_at(begin, end, friction, s)[0]
            height, rise = piece_at(begin, end, error, s)
            e, rate = e + strength * height, rate + strength * rise * s_dot + fading * height
        k, c = k * left, c * left
        if self.pair.mesh_stiffness == 'constant':
            share = 1 / self.sharing
            k, c = k * share, c * share
        return s, k, c, mu, e, rate

    def deltas(self, t, y):
        """Return delta and delta' of the whole gears."""
        e, e_dot = np.add(self.error(t), self.signal('transmission_error', t))
        return (
            y[3] - y[1] + self.rb1 * y[4] - self.rb2 * y[5] - e,
            y[9] - y[7] + self.rb1 * y[10] - self.rb2 * y[11] - e_dot,
        )

    def forces(self, t, y, pairs):
        """Return F, Ff, Tf1, Tf2."""
        delta, delta_dot = self.deltas(t, y)
        total = [0.0, 0.0, 0.0, 0.0]
        self.sharing = len(pairs)
        for pair in pairs:
            s, k, c, mu, e, e_dot = self.pair_terms(pair, t)
            x, v = delta - e, delta_dot - e_dot
            b, b_dot = self.half_backlash(t)
            force = k * (x - pair.contact * b) if pair.contact else 0.0
            if self.pair.damping_in_gap:
                force += c * v
            elif pair.contact:
                force += c * (v - pair.contact * b_dot)
            friction = pair.contact * pair.sliding * mu * force
            arm = self.arm0 + s
            for i, term in enumerate(
                (force, friction, friction * arm, friction * (self.arm_sum - arm))
            ):
                total[i] += term
        return total

    def slope(self, t, y, pairs):
        """Return y' with y = six positions, six velocities, integral of q."""
        x1, y1, x2, y2, th1, th2, vx1, vy1, vx2, vy2, w1, w2, q_sum = y
        force, friction, moment1, moment2 = self.forces(t, y, pairs)
        torque, accel, ratio = self.load(t), self.accel, self.rb1 / self.rb2
        q = (self.i1 * th1 + ratio * self.i2 * th2) / self.it
        q_dot = (self.i1 * w1 + ratio * self.i2 * w2) / self.it
        drive = torque * ratio
        if self.drive:
            drive += ratio * self.i2 * ratio * accel + self.i1 * accel
            drive -= self.kd * q + self.cd * q_dot + self.ki * q_sum
        drive += self.signal('drive_torque', t)[0]
        torque += self.signal('load_torque', t)[0]
        sum_1x, sum_1y = self.on_body('pinion', self.m1, (x1, y1), (vx1, vy1), t)
        sum_2x, sum_2y = self.on_body('gear', self.m2, (x2, y2), (vx2, vy2), t)
        return np.array(
            [
                *y[6:12],
                friction / self.m1 + sum_1x,
                force / self.m1 + sum_1y,
                -friction / self.m2 + sum_2x,
                -force / self.m2 + sum_2y,
                (drive - self.rb1 * force + moment1) / self.i1 - accel,
                (-torque + self.rb2 * force - moment2) / self.i2 - accel * ratio,
                q if self.drive else 0.0,
            ]
        )

    def support(self, wheel, t):
        """Return stiffness and damping of a support."""
        k, c = (self.k1, self.c1) if wheel == 'pinion' else (self.k2, self.c2)
        k += self.signal(f'{wheel}_support_stiffness', t)[0]
        return k, c + self.signal(f'{wheel}_support_damping', t)[0]

    def on_body(self, wheel, mass, position, velocity, t):
        """Return the accelerations of a body by its support and by forces on it."""
        k, c = self.support(wheel, t)
        for axis, x, v in zip('xy', position, velocity, strict=True):
            rest, rest_dot = self.signal(f'{wheel}_rest_{axis}', t)
            force = self.signal(f'{wheel}_force_{axis}', t)[0]
            yield (force - k * (x - rest) - c * (v - rest_dot)) / mass

    def row(self, t, y, pairs):
        """Return the columns of a sample."""
        rates = self.slope(t, y, pairs)
        force, friction = self.forces(t, y, pairs)[:2]
        delta, delta_dot = self.deltas(t, y)
        (turned, speed), turn = self.rigid_motion(t), 2 * math.pi
        ratio = self.pair.pinion_teeth / self.pair.gear_teeth
        angles = (turned + y[4]) % turn, (turned * ratio + y[5]) % turn
        return [
            *rates[6:10],
            *(force, friction, delta, delta_dot, *angles, speed + y[10]),
            self.load(t) + self.signal('load_torque', t)[0],
        ]

    def static_state(self):
        """Return the static deflection at t = 0 with q = 0 and delta' = 0.

        The unknowns x1, y1, x2, y2, psi = rb1 th1 - rb2 th2 and their balance are linear while all
        pairs touch, so Newton's method with any step is exact: it is solved as a linear system.
        """
        self._follow_commands(0.0)
        self.near = 1e-12
        pairs = self.pairs_at(self.phase(1e-12))
        flank = 1 if self.torque(0.0) >= 0 else -1
        for pair in pairs:
            pair.contact = flank

        def state(u):
            th1 = u[4] / (self.rb1 + self.rb2 * self.i1 * self.rb2 / (self.rb1 * self.i2))
            y = np.zeros(13)
            y[:4], y[4], y[5] = u[:4], th1, -th1 * self.i1 * self.rb2 / (self.rb1 * self.i2)
            e_dot = self.error(0.0)[1] + self.signal('transmission_error', 0.0)[1]
            y[10] = e_dot / (self.rb1 + self.rb2 * self.i1 * self.rb2 / (self.rb1 * self.i2))
            y[11] = -y[10] * self.i1 * self.rb2 / (self.rb1 * self.i2)
            return y

        def residual(u):
            y = state(u)
            damping, self.c = self.c, 0.0
            force, friction, _, moment2 = self.forces(0.0, y, pairs)
            self.c = damping
            on_body = [
                self.support(wheel, 0.0)[0] * (self.signal(f'{wheel}_rest_{axis}', 0.0)[0] - x)
                + self.signal(f'{wheel}_force_{axis}', 0.0)[0]
                for (wheel, axis), x in zip(
                    itertools.product(('pinion', 'gear'), 'xy'), u[:4], strict=True
                )
            ]
            return np.array(
                [
                    friction + on_body[0],
                    force + on_body[1],
                    -friction + on_body[2],
                    -force + on_body[3],
                    (-self.torque(0.0) + self.rb2 * force - moment2) / self.rb2,
                ]
            )

        start = np.array([0, 0, 0, 0, flank * self.b])
        scale = 1e-5
        jacobian = np.stack(
            [(residual(start + scale * d) - residual(start - scale * d)) / (2 * scale)
             for d in np.eye(5)], axis=1
        )  # fmt: skip
        u = start - np.linalg.solve(jacobian, residual(start))
        u = u - np.linalg.solve(jacobian, residual(u))
        return state(u)
