// What is measured in C and C++: recursive least squares, and the tick of the estimator.
//
// A recursion minimises |eta|^2 / P_0 + sum (y(k) - F(k)' eta)^2. What <name>_start makes exists
// until the end of the process; it is NULL if it is refused.
#include <algorithm>
#include <cstring>

#include <Eigen/Dense>

#include "sigmahat.h"
extern "C" {
#include "least_squares.h"
}

namespace {

class Recursion {
public:
    virtual ~Recursion() = default;
    // Takes samples F [size: samples x size], y [size: samples] in order, and writes the estimate.
    virtual void run(const double *F, const double *y, int samples, double *eta) = 0;
};

class Own final : public Recursion {
    alignas(16) sh_least_squares rls; // as malloc would place it

public:
    Own(int size, double P_0)
    {
        sh_least_squares_start(&rls, size, nullptr, P_0);
    }

    void run(const double *F, const double *y, int samples, double *eta) override
    {
        sh_innovation innovation;

        for (int k = 0; k < samples; ++k) {
            const double *row = F + k * rls.P.size;
            sh_least_squares_update(&rls, SH_RLS_STANDARD, 1.0, row, y[k], &innovation);
        }
        std::copy_n(rls.eta, rls.P.size, eta);
    }
};

// The few lines one would write with Eigen.
template <int size> class Eigens final : public Recursion {
    using Vector = Eigen::Matrix<double, size, 1>;
    Eigen::Matrix<double, size, size> P;
    Vector estimate = Vector::Zero();

public:
    EIGEN_MAKE_ALIGNED_OPERATOR_NEW

    explicit Eigens(double P_0) : P(P_0 * Eigen::Matrix<double, size, size>::Identity())
    {
    }

    void run(const double *F, const double *y, int samples, double *eta) override
    {
        for (int k = 0; k < samples; ++k) {
            const Eigen::Map<const Vector> f(F + k * size);
            const Vector Pf = P * f;
            const Vector gain = Pf / (1.0 + f.dot(Pf));
            estimate += gain * (y[k] - f.dot(estimate));
            P.noalias() -= gain * Pf.transpose();
        }
        Eigen::Map<Vector>{eta} = estimate;
    }
};

// For comparison, no complete recursion: the update of the covariance alone, as in textbooks,
// K = P F / (1 + F' P F), P -= K F' P, with all entries of P. It has no estimate.
template <int size> class Covariance final : public Recursion {
    alignas(16) double P[size][size] = {};

public:
    explicit Covariance(double P_0)
    {
        for (int i = 0; i < size; ++i) {
            P[i][i] = P_0;
        }
    }

    void run(const double *F, const double *, int samples, double *) override
    {
        for (int k = 0; k < samples; ++k) {
            update(F + k * size);
        }
    }

private:
    void update(const double *F)
    {
        double PF[size], K[size], S = 1.0;

        for (int i = 0; i < size; ++i) {
            PF[i] = 0.0;
            for (int j = 0; j < size; ++j) {
                PF[i] += P[i][j] * F[j];
            }
            S += F[i] * PF[i];
        }
        for (int i = 0; i < size; ++i) {
            K[i] = PF[i] / S;
        }
        for (int i = 0; i < size; ++i) {
            for (int j = 0; j < size; ++j) {
                P[i][j] -= K[i] * PF[j];
            }
        }
    }
};

// A recursion whose size the compiler knows.
template <template <int> class Make> Recursion *start(int size, double P_0)
{
    switch (size) {
    case 3:
        return new Make<3>(P_0);
    case 6:
        return new Make<6>(P_0);
    case 18:
        return new Make<18>(P_0);
    case 40:
        return new Make<40>(P_0);
    default:
        return nullptr;
    }
}

struct Tick {
    sh_parameters parameters;
    sh_estimator estimator;
    sh_estimate estimate;
};

} // namespace

extern "C" {

Recursion *sigmahat_start(int size, double P_0)
{
    return size <= SH_MAX_PARAMETERS ? new Own(size, P_0) : nullptr;
}

Recursion *eigen_start(int size, double P_0)
{
    return start<Eigens>(size, P_0);
}

Recursion *covariance_start(int size, double P_0)
{
    return start<Covariance>(size, P_0);
}

void recursion_run(Recursion *rls, const double *F, const double *y, int samples, double *eta)
{
    rls->run(F, y, samples, eta);
}

// A new estimator of the AwAS with n = 6, m = 3, in the modality Residual; FilteredRegression
// estimates all three motor data.
Tick *tick_start(const char *method)
{
    Tick *own = new Tick;
    sh_prior_parameters &prior = own->parameters.prior;
    sh_violation violation;

    sh_parameters_default(&own->parameters);
    if (std::strcmp(method, "Paper2011") != 0) {
        own->parameters.method = SH_METHOD_FILTERED_REGRESSION;
        prior.B = 0.03;
    }
    if (std::strcmp(method, "FilteredRegression, 21 columns") == 0) {
        prior.bias = prior.damping = prior.load_friction = prior.eccentric = 0;
        prior.delay = prior.reversal = 0;
        prior.power = prior.gap = prior.hysteresis = prior.eccentric_motor = 0;
    }
    if (sh_parameters_check(&own->parameters, &violation) != 0) {
        return nullptr;
    }
    sh_estimator_start(&own->estimator, &own->parameters, &own->estimate);
    return own;
}

// Runs ticks on z [size: samples x 5], and writes outputs of the last one [size: 3].
void tick_run(Tick *own, const double *z, int samples, double *outputs)
{
    for (int k = 0; k < samples; ++k) {
        const double *row = z + 5 * k;
        const sh_measurement measured = {row[0], row[1], row[2], row[3], row[4]};
        sh_estimator_tick(&own->estimator, &own->parameters, &measured, &own->estimate);
    }
    outputs[0] = own->estimate.sigma;
    outputs[1] = own->estimate.tau_e;
    outputs[2] = own->estimate.theta_dot;
}

} // extern "C"
