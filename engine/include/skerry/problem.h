// Frictional contact problems from files (FCLIB), and their solution without a world.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "components/options.h"
#include "components/types.h"

#pragma GCC visibility push(default)
namespace skerry {

/// A local contact problem u = W r + q, with components (normal, tangent 1, tangent 2) for each contact. The solution r
/// lies in the friction cone K_mu, (u_N + mu |u_T|, u_T) lies in the dual cone, and the two are orthogonal. W is stored
/// in compressed rows of 3x3 blocks.
struct ContactProblem {
    std::string name;
    std::vector<Index> row_offset;  // first block of each row; contacts + 1 entries
    std::vector<Index> column;      // block columns, ascending in each row, with the diagonal
    std::vector<Mat3> block;        // blocks of W [1/kg]
    std::vector<Vec3> q;            // velocities without reactions [m/s]
    std::vector<Real> mu;           // coefficients of friction
    std::string description;        // description in the file
    Index freedoms = 0;  // degrees of freedom of the global problem that was condensed; 0 for a local problem

    Index contacts() const { return static_cast<Index>(q.size()); }
};

struct ProblemSettings {
    SolverMethod method = SolverMethod::automatic;
    Friction friction = Friction::cone;
    Real tolerance = 1e-6;  // bound on ProblemSolution::error
    Index max_iterations = 100000;
    Real relaxation = 1;  // relaxation factor of the sweeps, > 0 and < 2; only for methods that sweep
};

struct ProblemSolution {
    std::vector<Vec3> reaction;  // in the contact frames of the problem [N s]
    Index regions = 0;
    Index iterations = 0;      // largest number of any region
    double seconds = 0;        // time of the solve alone [s]; median of repeated solves if it is short
    Real error = 0;            // measure of FCLIB and Siconos: |e| / max(|q|, |r|, |u|)
    Real error_absolute = 0;   // |e|
    Real error_over_q = 0;     // |e| / |q|
    Real energy_gap = 0;       // Coulomb gap, sum of r_N u_N + mu r_N |u_T| + r_T . u_T; 0 if Coulomb's law holds [J]
    Index largest_region = 0;  // contacts of the largest region
    Index unconverged = 0;     // regions that reached the iteration limit; 0 if converged
    bool converged = false;    // error <= tolerance
};

/// Reads the problem of an FCLIB file (HDF5). A local problem is read as it is. A global problem (M v = H r + f,
/// u = H^T v + w) is condensed to its contacts: W = H^T M^-1 H and q = H^T M^-1 f + w. Throws SceneError.
ContactProblem read_problem(const std::filesystem::path& file);

/// Writes a local problem in the format of FCLIB, with W in compressed columns, so that other solvers can read it. If
/// reactions are given (one per contact), a solution is written, too. Equal problems give equal bytes. The file appears
/// complete or not at all. Throws SceneError if the problem is empty, if its arrays disagree, or if the file cannot be
/// written.
void write_problem(const ContactProblem& problem, const std::filesystem::path& file,
                   std::span<const Vec3> reaction = {});

/// The subproblem of the given contacts (in ascending order), with the reactions of all others zero. Exact for a
/// region. Throws SceneError.
ContactProblem part_of(const ContactProblem& problem, std::span<const Index> contacts);

/// Separates the problem into regions and solves them from r = 0. With Friction::pyramid the errors of the solution,
/// and so `converged`, refer to the pyramid: the natural map clamps tangential components one by one. Throws SceneError
/// if the arrays of the problem disagree or a setting is out of its range.
ProblemSolution solve_problem(const ContactProblem& problem, const ProblemSettings& settings = {});

/// Errors of given reactions as in FCLIB and Siconos (rho = 1, docs/methods/errors.md 3), and the Coulomb gap.
struct ProblemError {
    Real absolute, relative, over_q;  // |e|, |e| / max(|q|, |r|, |u|), |e| / |q|
    Real energy_gap;                  // see ProblemSolution::energy_gap [J]
};
ProblemError problem_error(const ContactProblem& problem, std::span<const Vec3> reaction);

/// Nodes with a coupled mass matrix: an impulse on one of them moves all.
struct CoupledNodes {
    std::vector<Index> node;
    std::vector<Real> inverse;  // inverse mass matrix, row by row, symmetric [1/kg]
};

/// The nodes of a rigid body, or of the rigid motion of an implicit body, that contacts touch.
struct RigidPoints {
    std::vector<Index> node;
    std::vector<Vec3> arm;                // position relative to the centre of mass [m]
    Real inverse_mass = 0;                // [1/kg]
    Mat3 inverse_inertia = Mat3::Zero();  // [1/(kg m^2)]
    Real radius = 0;            // of a round body: distance of its contact points from its nodes, the core [m]
    std::vector<Vec3> touch{};  // of a cylinder: contact point of each contact, from the centre of mass [m]
};

/// The nodes of an implicit body that contacts touch: response of its deformation, without the rigid motion
/// (RigidPoints).
struct StrainedPoints {
    std::vector<Index> node;
    std::vector<Mat3> response;  // velocity per impulse, row by row, symmetric [1/kg]
};

/// Contacts between point masses, in world axes: u_i = sum_a weight[a] velocity[node[a]] + offset_i. An impulse r_i
/// adds weight[a] inverse_mass[node[a]] r_i to the velocity of node a.
struct LumpedContacts {
    // one entry per contact
    std::vector<std::array<Index, 4>> node;
    std::vector<std::array<Real, 4>> weight;
    std::vector<Vec3> normal;  // unit
    // velocity offset from gaps, collider motion and the spin of round bodies, less half of the rotation of the slip by
    // forces within the step [m/s]
    std::vector<Vec3> offset;
    std::vector<Real> friction;  // mu
    // one entry per node
    std::vector<Real> inverse_mass;  // 0: no impulse moves the node [1/kg]
    std::vector<Vec3> velocity;      // without the contacts [m/s]
    // for nodes in these lists inverse_mass must not be 0, and its value is not used
    std::vector<CoupledNodes> coupled{};
    std::vector<RigidPoints> rigid{};
    std::vector<StrainedPoints> strained{};
};

/// Converts lumped contacts to a problem with general blocks. The frame of a contact is right-handed: its normal and
/// two tangents that depend on the normal alone. Every contact needs a node that moves.
ContactProblem assemble_problem(const LumpedContacts& contacts, const std::string& name);

/// Transforms world vectors, one per contact, into the contact frames.
std::vector<Vec3> in_contact_frames(const LumpedContacts& contacts, std::span<const Vec3> vectors);

/// The contact problem of one step of a world as its solver received it, and the impulses that the step used. Contacts
/// that no impulse can move are left out.
struct StepProblem {
    std::uint64_t step = 0;      // number of the step, from 1
    Real time = 0;               // time at the start of the step [s]
    Real step_size = 0;          // [s]
    LumpedContacts lumped;       // contacts as used by the step
    ContactProblem problem;      // the same contacts as general blocks
    std::vector<Vec3> impulse;   // in the contact frames of the problem [N s]
    std::vector<Index> contact;  // index of each contact of the problem in World::contacts()
    std::vector<Index> region;   // region of each contact of the problem
};

}  // namespace skerry
#pragma GCC visibility pop
