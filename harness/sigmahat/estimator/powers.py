"""The powers of the deformation in the polynomial of the estimator."""


def powers_of_phi(symmetric: bool, n: int) -> list[int]:
    """Returns the powers of the deformation in a polynomial of order n, (18)."""
    return [2 * i + 1 if symmetric else i for i in range(n)]
