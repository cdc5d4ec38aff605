// The factorisation for Newton steps on contacts between bodies, against Eigen's dense one.
#include <Eigen/Core>
#include <catch2/catch.hpp>
#include <random>
#include <vector>

#include "systems/solver/equations/block_factor.h"
#include "tests/support/dense_algebra.h"

namespace skerry::test::block_factor_test {

namespace {

std::vector<Real> random_numbers(std::size_t count, unsigned seed) {
    std::mt19937 engine(seed);
    std::uniform_real_distribution<Real> number(-1, 1);
    std::vector<Real> all(count);
    for (Real& one : all) one = number(engine);
    return all;
}
Eigen::Map<Eigen::MatrixXd> matrix_of(std::vector<Real>& numbers, Index rows, Index columns) {
    return {numbers.data(), rows, columns};
}
DenseBlock block_of(std::vector<Real>& numbers, Index rows, Index columns) {
    return {numbers.data(), rows, columns, rows};
}

}  // namespace

TEST_CASE("a dense factor that exchanges rows agrees with Eigen", "[solver]") {
    const auto size = GENERATE(Index{1}, Index{3}, Index{8}, Index{9}, Index{30}, Index{77});
    const auto columns = GENERATE(Index{5}, Index{23});  // many columns are solved with inverses of triangles
    CAPTURE(size, columns);
    const auto count = static_cast<std::size_t>(size);
    std::vector<Real> numbers = random_numbers(count * count, 7);
    if (size > 1) numbers[0] = 0;  // makes another pivot necessary
    std::vector<Real> right = random_numbers(count * static_cast<std::size_t>(columns), 8);
    const Eigen::MatrixXd expected = solve_dense(matrix_of(numbers, size, size), matrix_of(right, size, columns));
    std::vector<Index> pivot(count);
    REQUIRE(factor_dense(block_of(numbers, size, size), pivot.data()));
    solve_dense(block_of(numbers, size, size), pivot.data(), block_of(right, size, columns));
    CHECK((matrix_of(right, size, columns) - expected).norm() < 1e-10 * expected.norm());
}

TEST_CASE("a singular matrix has no dense factor", "[solver]") {
    std::vector<Real> numbers(9, 1);
    std::vector<Index> pivot(3);
    CHECK(!factor_dense(block_of(numbers, 3, 3), pivot.data()));
}

TEST_CASE("a product is taken off a matrix of any shape", "[solver]") {
    const auto rows = GENERATE(Index{1}, Index{8}, Index{13}), columns = GENERATE(Index{1}, Index{4}, Index{7});
    std::vector<Real> a = random_numbers(static_cast<std::size_t>(rows) * 6, 1);
    std::vector<Real> b = random_numbers(static_cast<std::size_t>(columns) * 6, 2);
    std::vector<Real> c = random_numbers(static_cast<std::size_t>(rows * columns), 3);
    const Eigen::MatrixXd expected = matrix_of(c, rows, columns) - matrix_of(a, rows, 6) * matrix_of(b, 6, columns);
    subtract_product(block_of(a, rows, 6), block_of(b, 6, columns), block_of(c, rows, columns));
    CHECK((matrix_of(c, rows, columns) - expected).norm() < 1e-14);
}

TEST_CASE("zeros of a dense matrix are left out, bit for bit", "[solver]") {
    constexpr Index size = 40, columns = 45;
    std::vector<Real> a = random_numbers(size * size, 1), b = random_numbers(size * columns, 2);
    // A band, as of contacts between two faces, and zero columns where no contact presses, in runs of four and of many.
    for (Index c = 0; c < size; ++c)
        for (Index r = 0; r < size; ++r)
            if (std::abs(c - r) > 5) a[static_cast<std::size_t>(c * size + r)] = 0;
    const auto is_zero = [](Index c) { return c < 9 || (c >= 13 && c < 25) || c == 30 || c >= 43; };
    std::vector<Real> gaps = b;
    for (Index c = 0; c < columns; ++c)
        if (is_zero(c)) std::fill_n(gaps.begin() + c * size, size, Real(0));

    std::vector<Real> product(size * columns, 0), expected(size * columns, 0);
    subtract_product(block_of(a, size, size), block_of(gaps, size, columns), block_of(product, size, columns));
    for (Index c = 0; c < columns; ++c)
        for (Index r = 0; r < size; ++r) {
            Real sum = 0;
            for (Index k = 0; k < size; ++k)
                sum += a[static_cast<std::size_t>(k * size + r)] * gaps[static_cast<std::size_t>(c * size + k)];
            expected[static_cast<std::size_t>(c * size + r)] -= sum;
        }
    CHECK(product == expected);

    std::vector<Real> factors = random_numbers(size * size, 3);
    std::vector<Index> pivot(size);
    REQUIRE(factor_dense(block_of(factors, size, size), pivot.data()));
    solve_dense(block_of(factors, size, size), pivot.data(), block_of(gaps, size, columns));
    solve_dense(block_of(factors, size, size), pivot.data(), block_of(b, size, columns));
    for (Index c = 0; c < columns; ++c)
        if (is_zero(c)) std::fill_n(b.begin() + c * size, size, Real(0));
    CHECK(gaps == b);
}

TEST_CASE("a product with a vector is added to one of any length", "[solver]") {
    const auto rows = GENERATE(Index{1}, Index{8}, Index{13}), columns = GENERATE(Index{1}, Index{4}, Index{11});
    std::vector<Real> a = random_numbers(static_cast<std::size_t>(rows * columns), 1);
    std::vector<Real> x = random_numbers(static_cast<std::size_t>(columns), 2);
    std::vector<Real> y = random_numbers(static_cast<std::size_t>(rows), 3);
    const Eigen::MatrixXd expected = matrix_of(y, rows, 1) + matrix_of(a, rows, columns) * matrix_of(x, columns, 1);
    add_product(block_of(a, rows, columns), a.data(), x.data(), y.data());
    CHECK((matrix_of(y, rows, 1) - expected).norm() < 1e-14);
}

TEST_CASE("a sparse matrix of blocks is solved as the dense one, and as often as it is filled", "[solver]") {
    // A ring with a chord: the factor has fill-in.
    const std::vector<Index> sizes{3, 6, 9, 6, 12, 3};
    const std::vector<std::array<Index, 2>> pairs{{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 5}, {5, 0}, {1, 4}};
    BlockFactor factor;
    factor.start();
    Index total = 0;
    for (const Index size : sizes) total += factor.add_part(size) >= 0 ? size : 0;
    factor.close_parts();
    for (const auto& pair : pairs) factor.couple(pair[0], pair[1]);
    REQUIRE(factor.analyse());
    CHECK(factor.work() > 0);

    for (unsigned seed = 0; seed < 2; ++seed) {
        Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(total, total);
        std::ranges::fill(factor.numbers(), Real(0));
        const auto fill = [&](Index g, Index h) {
            std::vector<Real> numbers =
                random_numbers(static_cast<std::size_t>(factor.size(g) * factor.size(h)), 10 * seed + 7 * g + h);
            const DenseBlock to = factor.block(g, h);
            for (Index c = 0; c < to.columns; ++c)
                for (Index r = 0; r < to.rows; ++r) {
                    const Real number = numbers[static_cast<std::size_t>(c * to.rows + r)] + (g == h && c == r ? 4 : 0);
                    to.column(c)[r] = number;
                    dense(static_cast<Index>(factor.first(g)) + r, static_cast<Index>(factor.first(h)) + c) = number;
                }
        };
        for (Index g = 0; g < factor.part_count(); ++g) fill(g, g);
        for (const auto& pair : pairs) fill(pair[0], pair[1]), fill(pair[1], pair[0]);
        std::vector<Real> x = random_numbers(static_cast<std::size_t>(total), 99);
        const Eigen::VectorXd expected = Eigen::Map<Eigen::VectorXd>(x.data(), total);
        const std::vector<Real> blocks(factor.numbers().begin(), factor.numbers().end());
        factor.multiply(blocks, x);
        const Eigen::Map<const Eigen::VectorXd> right(factor.right().data(), total);
        CHECK((right - dense * expected).norm() < 1e-12);
        REQUIRE(factor.solve());
        CHECK((right - expected).norm() < 1e-10);
    }
}

}  // namespace skerry::test::block_factor_test
