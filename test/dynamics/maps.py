"""Maps in closed form, as the algorithms on stroboscopic maps take them."""

import numpy as np


class PlaneMap:
    """A map of the plane; a cycle is 1 long."""

    dimension = 2
    cycle = 1.0

    def iterate(self, states):
        return np.array([self.image(*state) for state in states])

    def tangent(self, states):
        return self.iterate(states), np.array([self.jacobian(*state) for state in states])


class Henon(PlaneMap):
    """x' = 1 - a x^2 + y, y' = b x (Henon 1976)."""

    def __init__(self, a, b=0.3):
        self.a, self.b = a, b

    def image(self, x, y):
        return [1 - self.a * x * x + y, self.b * x]

    def jacobian(self, x, y):
        return [[-2 * self.a * x, 1], [self.b, 0]]


class DelayedLogistic(PlaneMap):
    """x' = y, y' = a y (1 - x) (Maynard Smith 1968)."""

    def __init__(self, a):
        self.a = a

    def image(self, x, y):
        return [y, self.a * y * (1 - x)]

    def jacobian(self, x, y):
        return [[0, 1], [-self.a * y, self.a * (1 - x)]]
