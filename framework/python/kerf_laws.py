"""What a law in Python is made of: declarations, which are those of the C++ laws, and algebra of tensors.

    from kerf_laws import Material, deviator, real, state, von_mises

    class Perfect(Material):
        "J2 flow at one stress"
        shear_modulus = real("Pa", "elastic shear modulus", above=0)
        yield_stress = real("Pa", "flow stress", above=0)
        effective_plastic_strain = state("-", "equivalent plastic strain")

        def update(self, p):
            trial = p.deviator + 2 * self.shear_modulus * deviator(p.strain_increment)
            q = von_mises(trial)
            excess = np.maximum(q - self.yield_stress, 0)
            p.deviator = (1 - excess / np.maximum(q, 1e-300)) * trial
            p.state.effective_plastic_strain += excess / (3 * self.shear_modulus)
            return self.shear_modulus

Every number of a point is an array over the points of a block; tensors have six rows, xx, yy, zz, xy, yz, zx, and shear
strains are tensor components. Units are SI, stress is positive in tension, pressure in compression.
"""

import itertools

_order = itertools.count()


class _Declared:
    def __init__(self, **what):
        self.what, self.order = what, next(_order)


def real(unit, doc, default=None, above=None, least=None, below=None, most=None):
    """A parameter of the input: a number with a unit. `default` is a text, as a user would write it; bounds are `above`
    (not included) or `least`, `below` (not included) or `most`."""
    return _Declared(role="parameter", unit=unit, doc=doc, default=None if default is None else str(default),
                     low=above if above is not None else least, high=below if below is not None else most,
                     low_open=above is not None, high_open=below is not None)


def state(unit, doc, initial=0.0):
    """A number that every point keeps."""
    return _Declared(role="state", unit=unit, doc=doc, initial=initial, tensor=False)


def tensor(unit, doc):
    """A symmetric tensor that every point keeps, zero at first, turned with the material before the law is called."""
    return _Declared(role="state", unit=unit, doc=doc, initial=0.0, tensor=True)


def reads(doc, default=None):
    """A state variable of this name of another law of the material; `default` where no law keeps it."""
    return _Declared(role="reads", doc=doc, default=default)


class Law:
    kind = None
    name = None  # by default the name of the class in snake_case
    inputs = ()  # of "length", "initial_length", "reference_position", "rotation"


class Material(Law):
    """Law of the deviator. update(p) changes p.deviator and p.state and returns the shear modulus [Pa]."""
    kind = "material"


class Solid(Law):
    """Law of the whole stress. update(p) changes p.stress and p.state and returns the shear and the bulk modulus."""
    kind = "solid"


class Eos(Law):
    """Equation of state. evaluate(p) changes p.state and returns the pressure and the adiabatic bulk modulus [Pa]."""
    kind = "eos"
    uses_energy = True  # False where the pressure does not depend on p.specific_energy


class Erosion(Law):
    """Criterion. judge(p) changes p.state and returns its value and where the element has failed; a criterion that
    softens returns the shares that are left of the deviator, of tension and of compression as well."""
    kind = "erosion"
    softens = False


def trace(t):
    return t[0] + t[1] + t[2]


def deviator(t):
    """What is left of a tensor without its mean."""
    mean = trace(t) / 3
    result = t.copy()
    result[:3] -= mean
    return result


def contraction(a, b):
    """a : b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + 2 * (a[3] * b[3] + a[4] * b[4] + a[5] * b[5])


def von_mises(s):
    """sqrt(3/2 s:s) of a deviator, as in C++: of a whole stress, take its deviator first."""
    return (1.5 * contraction(s, s)) ** 0.5
