// Frictional contact problems from files (FCLIB), and their solution on their own.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "components/options.h"
#include "components/types.h"

namespace skerry {

/// A local problem: u = W r + q, per contact (normal, tangent 1, tangent 2), K_mu containing r orthogonal to (u_N + mu |u_T|, u_T) in the
/// dual cone. W in compressed rows of 3x3 blocks.
struct ContactProblem {
    std::string name;
    std::vector<Index> row_offset;  // contacts + 1
    std::vector<Index> column;      // block columns, ascending in a row; the diagonal is always there
    std::vector<Mat3> block;        // s/kg
    std::vector<Vec3> q;            // m/s
    std::vector<Real> mu;

    Index contacts() const { return static_cast<Index>(q.size()); }
};

struct ProblemSettings {
    SolverMethod method = SolverMethod::pgs;
    Friction friction = Friction::cone;
    Real tolerance = 1e-6;  // on `error`
    Index max_iterations = 100000;
};

struct ProblemSolution {
    std::vector<Vec3> reaction;  // N s, in the frames of the problem
    Index regions = 0;
    Index iterations = 0;     // the most of any region
    double seconds = 0;       // of the solve alone; median of repeated solves when it is short
    Real error = 0;           // of FCLIB and Siconos: |e| / max(|q|, |r|, |u|)
    Real error_absolute = 0;  // |e|
    Real error_over_q = 0;    // |e| / |q|
    bool converged = false;
};

/// Reads the local problem of an FCLIB file (HDF5). Throws SceneError.
ContactProblem read_problem(const std::filesystem::path& file);

/// Separates the problem into regions and solves them from r = 0. With Friction::pyramid the errors of the solution are those of the
/// pyramid (the tangential components of the natural map clamped one by one), which is what `converged` asks for. Throws SceneError
/// when the arrays of the problem disagree.
ProblemSolution solve_problem(const ContactProblem& problem, const ProblemSettings& settings = {});

/// |e| of methods.md 2.1 (FCLIB and Siconos, rho = 1) for given reactions.
struct ProblemError {
    Real absolute, relative, over_q;
};
ProblemError problem_error(const ContactProblem& problem, std::span<const Vec3> reaction);

}  // namespace skerry
