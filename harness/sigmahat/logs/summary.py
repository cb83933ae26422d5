"""The result of a replay as text, for people."""

from __future__ import annotations

from sigmahat.logs.estimate import Estimate


def summary(result: Estimate) -> str:
    """One screen."""
    p = result.parameters
    low, high = result.sigma_range
    torque = result.tau_e_range[1] - result.tau_e_range[0]
    relative = 100 * result.epsilon_rms / torque if torque else float("nan")
    lines = [f"{result.log}", *(f"  {note}" for note in result.notes), ""]
    lines += [
        f"method {p['method']}, modality {p['modality']}, T = {result.T:g} s, "
        f"rls.n = {p['rls.n']}, rls.m = {p['rls.m']}, "
        f"{'odd' if p['rls.symmetric'] else 'general'} polynomial",
        f"motor: B = {p['motor.B']:.4g} kg.m2, D_theta = {p['motor.D_theta']:.4g} N.m.s/rad, "
        f"gamma = {p['motor.gamma']:g}",
        "",
        "in the second half of the log:",
        f"  stiffness sigma       {low:10.4g} to {high:10.4g} N.m/rad",
        f"  torque tau_e, fitted  {result.tau_e_range[0]:10.4g} to {result.tau_e_range[1]:10.4g} "
        "N.m",
        f"  deformation phi       {result.phi_range[0]:10.4g} to {result.phi_range[1]:10.4g} rad",
        f"  prediction error RMS  {result.epsilon_rms:10.4g} N.m ({relative:.2g} % of the torque)",
        f"at the end: sigma = {result.sigma:.6g} N.m/rad, "
        f"standard deviation {result.sigma_std:.2g} N.m/rad; "
        f"{result.skipped} of {result.ticks} ticks skipped",
    ]
    if p["method"] == "MatchedFilter":
        B, D_theta, tau_coulomb = (
            result.motor[name] for name in ("B_hat", "D_theta_hat", "tau_coulomb_hat")
        )
        lines += [
            f"motor data found: B = {B:.4g} kg.m2, D_theta = {D_theta:.4g} N.m.s/rad, "
            f"Coulomb friction {tau_coulomb:.3g} N.m",
            f"confident {100 * result.confident:.3g} % of the second half",
        ]
    return "\n".join(lines)
