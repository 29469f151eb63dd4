"""Sums, products and compositions of polynomials in time, lowest coefficient first.

The degree of a polynomial is kept beside it; -1 says that it is zero, whatever its coefficients.
"""

from __future__ import annotations

from gear_dynamics.integrator.kernel import kernel
from gear_dynamics.model.port_checks import DEGREE


@kernel
def compose(coefficients, x0, x1, x2, out):
    """Fill `out` with the polynomial in x = x0 + x1 t + x2 t^2, in t; return its degree."""
    top = DEGREE
    while top > 0 and coefficients[top] == 0.0:
        top -= 1
    out[0] = coefficients[top]
    if x2 == 0.0:
        for j in range(top - 1, -1, -1):
            out[top - j] = x1 * out[top - j - 1]
            for i in range(top - j - 1, 0, -1):
                out[i] = x0 * out[i] + x1 * out[i - 1]
            out[0] = x0 * out[0] + coefficients[j]
        return top
    degree, by = 0, 2
    for j in range(top - 1, -1, -1):
        for i in range(degree + 1, degree + by + 1):
            out[i] = 0.0
        degree += by
        for i in range(degree, 0, -1):
            total = x0 * out[i] + x1 * out[i - 1]
            if i > 1:
                total += x2 * out[i - 2]
            out[i] = total
        out[0] = x0 * out[0] + coefficients[j]
    return degree


@kernel
def add_scaled(out, out_degree, terms, degree, factor, rate, width):
    """Add (factor + rate t) times a polynomial to another; return the degree of the sum."""
    last = degree + 1 if rate != 0.0 else degree
    last = min(last, width - 1)
    for i in range(out_degree + 1, last + 1):
        out[i] = 0.0
    for i in range(min(degree, width - 1) + 1):
        out[i] += factor * terms[i]
    if rate != 0.0:
        for i in range(min(degree, width - 2) + 1):
            out[i + 1] += rate * terms[i]
    return max(out_degree, last)


@kernel
def add_product(out, out_degree, a, a_degree, b, b_degree, factor, width):
    """Add factor times the product of two polynomials to `out`; return the degree of the sum.

    Terms of order `width` and above are left out.
    """
    if a_degree < 0 or b_degree < 0:
        return out_degree
    last = min(a_degree + b_degree, width - 1)
    for i in range(out_degree + 1, last + 1):
        out[i] = 0.0
    for i in range(min(a_degree, width - 1) + 1):
        scaled = factor * a[i]
        for j in range(min(b_degree, width - 1 - i) + 1):
            out[i + j] += scaled * b[j]
    return max(out_degree, last)


@kernel
def differentiate(a, degree, out):
    """Fill `out` with the derivative of a polynomial; return its degree."""
    for i in range(1, degree + 1):
        out[i - 1] = i * a[i]
    return degree - 1


@kernel
def copy_rows(rows, first, out):
    """Fill all rows of `out` with those of another array from row `first` on.

    Not a slice assignment: its check of the shapes takes seconds to compile.
    """
    for i in range(out.shape[0]):
        for j in range(out.shape[1]):
            out[i, j] = rows[first + i, j]
