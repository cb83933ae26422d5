// The few lines one would write with Eigen.
#include <Eigen/Dense>

namespace {

class Recursion {
public:
    virtual ~Recursion() = default;
    virtual void run(const double *F, const double *y, int samples) = 0;
    virtual void eta(double *to) const = 0;
};

template <int size> class Eigens final : public Recursion {
    using Vector = Eigen::Matrix<double, size, 1>;
    Eigen::Matrix<double, size, size> P;
    Vector estimate = Vector::Zero();

public:
    EIGEN_MAKE_ALIGNED_OPERATOR_NEW

    explicit Eigens(double P_0) : P(P_0 * Eigen::Matrix<double, size, size>::Identity())
    {
    }

    void run(const double *F, const double *y, int samples) override
    {
        for (int k = 0; k < samples; ++k) {
            const Eigen::Map<const Vector> f(F + k * size);
            const Vector Pf = P * f;
            const Vector gain = Pf / (1.0 + f.dot(Pf));
            estimate += gain * (y[k] - f.dot(estimate));
            P.noalias() -= gain * Pf.transpose();
        }
    }

    void eta(double *to) const override
    {
        Eigen::Map<Vector>{to} = estimate;
    }
};

} // namespace

extern "C" {

void *eigen_start(int size, double P_0)
{
    switch (size) {
    case 3:
        return new Eigens<3>(P_0);
    case 6:
        return new Eigens<6>(P_0);
    case 18:
        return new Eigens<18>(P_0);
    case 40:
        return new Eigens<40>(P_0);
    default:
        return nullptr;
    }
}

void eigen_run(void *rls, const double *F, const double *y, int samples)
{
    static_cast<Recursion *>(rls)->run(F, y, samples);
}

void eigen_eta(const void *rls, double *eta)
{
    static_cast<const Recursion *>(rls)->eta(eta);
}

} // extern "C"
