#include "kinematic_kalman.h"

#include "real_math.h"

/* Far below any velocity [rad/s] and lag [rad]. Processors compute slowly with denormal numbers. */
static const sh_real AT_REST = (sh_real)1e-30;

/* Returns the measurement variance R at a velocity, (11) [rad2]; V_min for an encoder without quantisation. */
static sh_real measurement_variance(const sh_filter_parameters *filter, sh_real x_dot, sh_real w_s)
{
    const sh_real speed = sh_fabs(x_dot);
    sh_real relative;

    if (!(w_s > 0)) {
        return filter->V_min;
    }
    relative = filter->weighting == SH_WEIGHTING_NORMALIZED ? speed / w_s : speed * w_s;
    /* (11). If exp overflows to infinity, R is V_min, which is correct. */
    return (filter->V_max - filter->V_min) / (1 + sh_exp((relative - 1) * filter->alpha)) +
           filter->V_min;
}

void sh_kinematic_kalman_start(sh_kinematic_kalman *kalman, const sh_filter_parameters *filter,
                               sh_real z)
{
    const sh_kinematic_kalman start = {.z = z, .P11 = filter->P_0, .P22 = filter->P_0};

    *kalman = start;
}

void sh_kinematic_kalman_step(sh_kinematic_kalman *kalman, const sh_filter_parameters *filter,
                              sh_real z, sh_real dt, sh_real w_s)
{
    const sh_real dz = z - kalman->z;
    sh_real innovation, lag, P11, P12, P22, R, S;

    kalman->z = z;

    if (filter->kind == SH_FILTER_FINITE_DIFFERENCE) {
        kalman->dx = dz;
        kalman->dx_dot = dz / dt - kalman->x_dot;
        kalman->x_dot = dz / dt;
        return;
    }

    /* (9): xi = A xi, P = A P A' + V_a Gamma Gamma', Gamma = (dt^2/2, dt)' */
    innovation = dz - kalman->lag - dt * kalman->x_dot; /* z - H xi */
    P11 = kalman->P11 + dt * (2 * kalman->P12 + dt * kalman->P22) +
          filter->V_a * (dt * dt) * (dt * dt) / 4;
    P12 = kalman->P12 + dt * kalman->P22 + filter->V_a * (dt * dt) * dt / 2;
    P22 = kalman->P22 + filter->V_a * (dt * dt);

    R = filter->kind == SH_FILTER_KALMAN ? filter->R
                                         : measurement_variance(filter, kalman->x_dot, w_s);

    /* (10): K = P H' / S, xi += K (z - H xi), P -= K H P with H = (1 0) */
    S = P11 + R;
    lag = -(R / S) * innovation; /* x - z, where x = z - innovation + P11 / S innovation */
    kalman->dx = dz + (lag - kalman->lag);
    kalman->dx_dot = P12 / S * innovation;
    kalman->lag = lag;
    kalman->x_dot += kalman->dx_dot;
    if (sh_fabs(kalman->lag) < AT_REST && sh_fabs(kalman->x_dot) < AT_REST) {
        kalman->lag = 0;
        kalman->x_dot = 0;
    }
    /* P11 (R / S) is equal to P11 - P11^2/S, but the subtraction would lose digits if P11 >> R. */
    kalman->P11 = P11 * (R / S);
    kalman->P12 = P12 * (R / S);
    kalman->P22 = sh_fmax(P22 - P12 * (P12 / S), 0); /* the difference may be below by rounding */
}
