// Uses Eigen as a host does, compiled with the host's own flags: matrices of any size, dense and sparse factorisations.
// Skerry contains weak functions with the same names, perhaps for other instructions and alignments. They must not mix.
#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <vector>

double solve_own_systems() {
    double sum = 0;
    for (int size = 1; size <= 40; ++size) {
        Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(size, size) * size;
        for (int i = 0; i + 1 < size; ++i) matrix(i, i + 1) = matrix(i + 1, i) = -1;
        const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(size, 0, 1);
        sum += matrix.partialPivLu().solve(right).norm() + matrix.llt().solve(right).sum() +
               matrix.colPivHouseholderQr().solve(right).squaredNorm();
        sum += Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix).eigenvalues().sum();

        std::vector<Eigen::Triplet<double>> entries;
        for (int i = 0; i < size; ++i) {
            entries.emplace_back(i, i, 2 + i);
            if (i > 0) entries.emplace_back(i, i - 1, -1);
            if (i + 1 < size) entries.emplace_back(i, i + 1, -1);
        }
        Eigen::SparseMatrix<double> sparse(size, size);
        sparse.setFromTriplets(entries.begin(), entries.end());
        const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors(sparse);
        sum += factors.solve(right).norm();
    }
    return sum;
}
