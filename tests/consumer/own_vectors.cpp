// Uses Eigen in the user's own code. The library may be built for another instruction set, with which Eigen aligns and
// frees memory in another way. The two must not mix.
#include <Eigen/Dense>

double own_vectors() {
    double sum = 0;
    for (int size = 1; size <= 1000; ++size) {
        const Eigen::VectorXd ones = Eigen::VectorXd::Constant(size, 1.0 / size);
        const Eigen::MatrixXd square = Eigen::MatrixXd::Identity(size % 17 + 1, size % 17 + 1);
        sum += ones.sum() * square(0, 0);
    }
    return static_cast<double>(static_cast<long>(sum + 0.5));
}
