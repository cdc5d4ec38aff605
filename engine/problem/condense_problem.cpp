#include "engine/problem/condense_problem.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

#include "components/union_find.h"
#include "engine/problem/gather_blocks.h"

namespace skerry {
namespace {

using SparseMatrix = Eigen::SparseMatrix<Real>;
using Factors = Eigen::SimplicialLDLT<SparseMatrix>;

/// Parts of the mass matrix M: groups of degrees of freedom such that no entry of M connects two groups. A part is
/// usually a body.
struct MassParts {
    std::vector<Index> part, place;  // for each degree of freedom: number of its part of M, and its index in this part
    std::vector<Index> size;         // number of degrees of freedom of each part of M
};

MassParts separate(const MatrixEntries& mass) {
    UnionFind joined;
    joined.start(static_cast<std::size_t>(mass.rows));
    for (const MatrixEntry& e : mass.entry)
        if (e.value != 0) joined.join(e.row, e.column);
    MassParts parts;
    for (Index i = 0; i < mass.rows; ++i) {
        const Index part = joined.number(i);
        parts.size.resize(static_cast<std::size_t>(joined.number_count));
        parts.part.push_back(part);
        parts.place.push_back(parts.size[part]++);
    }
    return parts;
}

/// Returns the entries of a matrix, grouped by the part of M (see MassParts) to which the row of each entry belongs.
std::vector<std::vector<MatrixEntry>> by_part(const MassParts& parts, const MatrixEntries& matrix) {
    std::vector<std::vector<MatrixEntry>> entries(parts.size.size());
    for (const MatrixEntry& e : matrix.entry) entries[parts.part[e.row]].push_back(e);
    return entries;
}

SparseMatrix assemble(const MassParts& parts, Index part, const std::vector<MatrixEntry>& entries) {
    std::vector<Eigen::Triplet<Real>> triplets;
    for (const MatrixEntry& e : entries)
        if (e.value != 0) triplets.emplace_back(parts.place[e.row], parts.place[e.column], e.value);
    SparseMatrix mass(parts.size[part], parts.size[part]);
    mass.setFromTriplets(triplets.begin(), triplets.end());
    return mass;
}

std::string freedom_text(const MassParts& parts, Index part, Index row) {
    for (std::size_t i = 0; i < parts.part.size(); ++i)
        if (parts.part[i] == part && parts.place[i] == row) return "degree of freedom " + std::to_string(i);
    return {};
}

MassFault asymmetry(const MassParts& parts, Index part, const SparseMatrix& mass) {
    // Upper limit of the asymmetry of an entry M_ij by rounding, relative to sqrt(M_ii M_jj). A matrix that is really
    // unsymmetric exceeds it by far.
    constexpr Real rounding = 1e-9;
    const SparseMatrix difference = mass - SparseMatrix(mass.transpose());
    const Eigen::VectorXd diagonal = mass.diagonal();
    for (Index column = 0; column < difference.outerSize(); ++column)
        for (SparseMatrix::InnerIterator it(difference, column); it; ++it)
            if (it.value() * it.value() > rounding * rounding * std::abs(diagonal[it.row()] * diagonal[column]))
                return {"a matrix that is not symmetric in the entries of " +
                            freedom_text(parts, part, static_cast<Index>(it.row())) + " and " +
                            freedom_text(parts, part, column),
                        "a symmetric matrix with both triangles stored"};
    return {};
}

MassFault factorise(const MassParts& parts, Index part, const SparseMatrix& mass, Factors& factors) {
    if (MassFault fault = asymmetry(parts, part, mass); !fault.found.empty()) return fault;
    const char* const expected = "a positive definite matrix";
    const Eigen::VectorXd diagonal = mass.diagonal();
    for (Index i = 0; i < diagonal.size(); ++i)
        if (!(diagonal[i] > 0))
            return {std::to_string(diagonal[i]) + " as the diagonal entry of " + freedom_text(parts, part, i),
                    expected};
    factors.compute(mass);
    // The matrix counts as singular if a pivot is within rounding errors of its diagonal entry.
    constexpr Real rounding = 1e-14;
    const Eigen::VectorXd in_order = factors.permutationP() * diagonal;
    bool definite = factors.info() == Eigen::Success;
    if (definite) definite = (factors.vectorD().array() > rounding * in_order.array()).all();
    if (definite) return {};
    return {"a matrix that is not positive definite in the block with " + freedom_text(parts, part, 0), expected};
}

/// Adds the contributions of one independent part of the mass matrix M to W and q of the contact problem.
void condense_part(const MassParts& parts, Index part, const Factors& factors,
                   const std::vector<MatrixEntry>& directions, const std::vector<Real>& force,
                   std::vector<BlockPart>& blocks, ContactProblem& problem) {
    std::vector<Index> contact;  // numbers of the contacts that act on this part of M, ascending
    for (const MatrixEntry& e : directions) contact.push_back(e.column / 3);
    std::sort(contact.begin(), contact.end());
    contact.erase(std::unique(contact.begin(), contact.end()), contact.end());
    const auto count = static_cast<Index>(contact.size());
    SparseMatrix h(parts.size[part], 3 * count);
    std::vector<Eigen::Triplet<Real>> triplets;
    for (const MatrixEntry& e : directions) {
        const auto local = std::lower_bound(contact.begin(), contact.end(), e.column / 3) - contact.begin();
        triplets.emplace_back(parts.place[e.row], static_cast<Index>(3 * local) + e.column % 3, e.value);
    }
    h.setFromTriplets(triplets.begin(), triplets.end());
    const Eigen::VectorXd free = factors.solve(Eigen::Map<const Eigen::VectorXd>(force.data(), parts.size[part]));
    const Eigen::VectorXd velocity = h.transpose() * free;
    for (Index i = 0; i < count; ++i) problem.q[contact[i]] += velocity.segment<3>(3 * i);
    // Contacts are processed in batches. The matrix M^-1 H of all contacts at once would be too large for a big body
    // with many contacts.
    constexpr Index batch = 32;
    for (Index begin = 0; begin < count; begin += batch) {
        const Index end = std::min(count, begin + batch);
        // The dense matrix is created with its final size. With EIGEN_NO_AUTOMATIC_RESIZING, Eigen would first clear
        // the empty matrix and then resize it, which leaves entries uninitialised.
        Eigen::MatrixXd pushed(parts.size[part], 3 * (end - begin));
        pushed = h.middleCols(3 * begin, 3 * (end - begin));
        const Eigen::MatrixXd moved = factors.solve(pushed);
        const Eigen::MatrixXd w = h.transpose() * moved;
        // Only blocks with i <= j are taken from `w`. Their transposes serve as the blocks (j, i), so W is bitwise
        // symmetric.
        for (Index j = begin; j < end; ++j)
            for (Index i = 0; i <= j; ++i) {
                Mat3 block = w.block<3, 3>(3 * i, 3 * (j - begin));
                if (i == j) block = 0.5 * (block + block.transpose()).eval();
                blocks.push_back({contact[i], contact[j], block});
                if (i != j) blocks.push_back({contact[j], contact[i], block.transpose()});
            }
    }
}

/// Drops blocks of W that are as small as rounding errors, compared with the diagonal blocks of their two contacts.
void drop_rounding(ContactProblem& problem) {
    constexpr Real rounding = 1e-14;
    const std::size_t count = problem.q.size();
    std::vector<Real> diagonal(count);
    for (std::size_t i = 0; i < count; ++i)
        for (Index k = problem.row_offset[i]; k < problem.row_offset[i + 1]; ++k)
            if (static_cast<std::size_t>(problem.column[k]) == i) diagonal[i] = problem.block[k].norm();
    std::vector<BlockPart> kept;
    for (std::size_t i = 0; i < count; ++i)
        for (Index k = problem.row_offset[i]; k < problem.row_offset[i + 1]; ++k) {
            const Index column = problem.column[k];
            if (problem.block[k].squaredNorm() <= rounding * rounding * diagonal[i] * diagonal[column]) continue;
            kept.push_back({static_cast<Index>(i), column, problem.block[k]});
        }
    gather_blocks(std::move(kept), problem);
}

}  // namespace

MassFault condense_problem(const GlobalProblem& global, ContactProblem& problem) {
    const MassParts parts = separate(global.mass);
    const std::vector<std::vector<MatrixEntry>> mass = by_part(parts, global.mass),
                                                directions = by_part(parts, global.directions);
    std::vector<std::vector<Real>> force(parts.size.size());
    for (std::size_t i = 0; i < global.force.size(); ++i) force[parts.part[i]].push_back(global.force[i]);
    std::vector<BlockPart> blocks;
    for (Index part = 0; part < static_cast<Index>(parts.size.size()); ++part) {
        Factors factors;
        if (MassFault fault = factorise(parts, part, assemble(parts, part, mass[part]), factors); !fault.found.empty())
            return fault;
        if (!directions[part].empty())
            condense_part(parts, part, factors, directions[part], force[part], blocks, problem);
    }
    problem.freedoms = global.mass.rows;
    gather_blocks(std::move(blocks), problem);
    drop_rounding(problem);
    return {};
}

}  // namespace skerry
