# Harmonics compared with SciPy (its basis and integrals) and SymPy (Gaunt's coefficients, in rational arithmetic).
#
#   python harmonics.py
#
# Debian: python3-scipy, python3-sympy. Prints a table in Markdown; fails above the bounds that it states.
import sys

import numpy as np
import scipy
import sympy
from scipy.integrate import quad
from scipy.special import eval_legendre, sph_harm
from scipy.spatial.transform import Rotation
from sympy.physics.wigner import gaunt

import welkin

random = np.random.default_rng(1)
failed = False


def row(what, library, difference, bound):
    global failed
    failed |= not difference <= bound
    print(f"| {what} | {library} | {difference:.1e}{'' if difference <= bound else ' FAILED'} |")


def directions(count):
    made = random.normal(size=(count, 3))
    return made / np.linalg.norm(made, axis=1, keepdims=True)


def theirs(d, bands):
    """Real harmonics without Condon-Shortley phase about +z, as Welkin has them: Y(1, -1..1) ~ y, z, x."""
    theta, phi = np.arccos(np.clip(d[:, 2], -1, 1)), np.arctan2(d[:, 1], d[:, 0])
    columns = []
    for l in range(bands):
        for m in range(-l, l + 1):
            y = sph_harm(abs(m), l, phi, theta) * (-1) ** m
            columns.append(y.real if m == 0 else np.sqrt(2) * (y.real if m > 0 else y.imag))
    return np.stack(columns, 1)


def real_to_complex(l):
    """Rows: complex m, with the phase of SymPy and SciPy; columns: real m."""
    u = np.zeros((2 * l + 1, 2 * l + 1), complex)
    for m in range(-l, l + 1):
        if m == 0:
            u[l, l] = 1
        elif m > 0:  # real m = sqrt(2) (-1)^m Re, real -m = sqrt(2) (-1)^m Im
            u[l + m, l + m] = (-1) ** m / np.sqrt(2)
            u[l + m, l - m] = 1j * (-1) ** m / np.sqrt(2)
            u[l - m, l + m] = 1 / np.sqrt(2)
            u[l - m, l - m] = -1j / np.sqrt(2)
    return u


print(f"SciPy {scipy.__version__}, SymPy {sympy.__version__}\n\n| what | beside | largest difference |\n|---|---|---|")
d = directions(200)
row("basis, 16 bands", "scipy.special.sph_harm", np.abs(welkin.basis(d, bands=16) - theirs(d, 16)).max(), 1e-12)

f = welkin.SphericalHarmonics(random.normal(size=(144, 3)))
turn = Rotation.from_rotvec([0.3, -1.1, 0.7]).as_matrix()
turned = f.rotate(turn)
there = theirs(d @ turn, 12) @ np.asarray(f.coefficients)
row("rotation, 12 bands", "scipy, basis at rotated directions", np.abs(theirs(d, 12) @ np.asarray(turned.coefficients) - there).max(), 1e-11)

BANDS = 4
a, b = random.normal(size=(2, BANDS * BANDS))
wanted = np.zeros((2 * BANDS - 1) ** 2, complex)
to_complex = [real_to_complex(l) for l in range(2 * BANDS - 1)]
# A complex coefficient is the integral of f times conj(Y): conj of the rows above.
ca = [np.conj(to_complex[l]) @ a[l * l : (l + 1) ** 2] for l in range(BANDS)]
cb = [np.conj(to_complex[l]) @ b[l * l : (l + 1) ** 2] for l in range(BANDS)]
for l3 in range(2 * BANDS - 1):
    complex3 = np.zeros(2 * l3 + 1, complex)
    for l1 in range(BANDS):
        for l2 in range(BANDS):
            if (l1 + l2 + l3) % 2 or l3 > l1 + l2 or l3 < abs(l1 - l2):
                continue
            for m1 in range(-l1, l1 + 1):
                for m2 in range(-l2, l2 + 1):
                    m3 = m1 + m2
                    if abs(m3) <= l3:
                        g = float(gaunt(l1, l2, l3, m1, m2, -m3)) * (-1) ** m3
                        complex3[l3 + m3] += ca[l1][l1 + m1] * cb[l2][l2 + m2] * g
    wanted[l3 * l3 : (l3 + 1) ** 2] = to_complex[l3].T @ complex3
triple = lambda x: welkin.SphericalHarmonics(np.repeat(x[:, None], 3, 1))
product = np.asarray(triple(a).product(triple(b), 2 * BANDS - 1).coefficients)[:, 0]
row("product of 4 and 4 bands, all 7", "sympy.physics.wigner.gaunt", np.abs(product - wanted.real).max(), 1e-11)

lobe = [2 * np.pi * quad(lambda x: eval_legendre(l, x) * x, 0, 1, epsabs=1e-13)[0] for l in range(24)]
row("cosine lobe, 24 bands", "scipy.integrate.quad", max(abs(welkin.cosine_lobe(l) - lobe[l]) for l in range(24)), 1e-11)
for name, kernel, value, bound in (
    ("Lambert's kernel, 24 bands", welkin.ZonalLobe.lambert(), lambda x: max(x, 0), 1e-9),
    ("Phong, power 32, 24 bands", welkin.ZonalLobe.phong(32), lambda x: max(x, 0) ** 32, 1e-9),
):
    mine = np.asarray(kernel.spectrum(24))
    k = [quad(lambda x: eval_legendre(l, x) * value(x), 0, 1, epsabs=1e-14)[0] for l in range(24)]
    row(name, "scipy.integrate.quad", np.abs(mine / mine[0] - np.array(k) / k[0]).max(), bound)
sys.exit(1 if failed else 0)
