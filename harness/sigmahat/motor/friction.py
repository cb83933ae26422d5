"""Lists forms of the motor equation with other models of friction, or with another low pass.

A value counts as known if these forms agree on it, because the friction of a real joint has a form
of its own.
"""

from dataclasses import replace

from sigmahat.motor.equation import COULOMB_VELOCITY, Form, Stribeck

STRIBECK = tuple(
    Stribeck(v, delta) for v in (0.01, 0.02, 0.04, 0.08, 0.16, 0.32) for delta in (1.0, 2.0)
)
_SLOWER = 0.6  # ratio of another low pass to the low pass of a form


def frictions(plain: Form) -> list[Form]:
    """Returns all forms of the equation with other models of friction."""
    load = replace(plain, load_friction=True)
    return [
        replace(plain, coulomb_velocity=COULOMB_VELOCITY / 4),
        replace(plain, coulomb_velocity=COULOMB_VELOCITY * 2),
        load,
        *(replace(form, stribeck=(one,)) for form in (plain, load) for one in STRIBECK),
    ]


def few_frictions(plain: Form) -> list[Form]:
    """Returns two forms with other models of friction, for fits with little computation."""
    return [
        replace(plain, load_friction=True),
        replace(plain, stribeck=(Stribeck(0.1, 2.0),)),
    ]


def slower(form: Form) -> Form:
    """Returns the form with a lower low pass."""
    return replace(form, f_0=_SLOWER * form.f_0)


def with_all_columns(form: Form) -> Form:
    """Returns the form whose equations contain those of all frictions with the same filters."""
    return replace(form, load_friction=True, stribeck=STRIBECK, delay=True)
