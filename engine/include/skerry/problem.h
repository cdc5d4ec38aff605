// Frictional contact problems from files (FCLIB), and their solution on their own.
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

/// A local problem: u = W r + q, per contact (normal, tangent 1, tangent 2), K_mu containing r orthogonal to (u_N + mu
/// |u_T|, u_T) in the dual cone. W in compressed rows of 3x3 blocks.
struct ContactProblem {
    std::string name;
    std::vector<Index> row_offset;  // contacts + 1
    std::vector<Index> column;      // block columns, ascending in a row; the diagonal is always there
    std::vector<Mat3> block;        // s/kg
    std::vector<Vec3> q;            // m/s
    std::vector<Real> mu;
    std::string description;  // what its file says of it
    Index freedoms = 0;       // of the global problem that it was condensed from; 0: it came as a local one

    Index contacts() const { return static_cast<Index>(q.size()); }
};

struct ProblemSettings {
    SolverMethod method = SolverMethod::automatic;
    Friction friction = Friction::cone;
    Real tolerance = 1e-6;  // on `error`
    Index max_iterations = 100000;
    Real relaxation = 1;  // of the sweeps, > 0 and < 2; only for methods that sweep
};

struct ProblemSolution {
    std::vector<Vec3> reaction;  // N s, in the frames of the problem
    Index regions = 0;
    Index iterations = 0;      // the most of any region
    double seconds = 0;        // of the solve alone; median of repeated solves when it is short
    Real error = 0;            // of FCLIB and Siconos: |e| / max(|q|, |r|, |u|)
    Real error_absolute = 0;   // |e|
    Real error_over_q = 0;     // |e| / |q|
    Real energy_gap = 0;       // J, Coulomb gap: sum of r_N u_N + mu r_N |u_T| + r_T . u_T; 0 where Coulomb's law holds
    Index largest_region = 0;  // contacts
    Index unconverged = 0;     // regions that ran into the limit of iterations; 0 when converged
    bool converged = false;
};

/// Reads the problem of an FCLIB file (HDF5): a local one as it is; a global one (M v = H r + f, u = H^T v + w)
/// condensed to its contacts, W = H^T M^-1 H and q = H^T M^-1 f + w. Throws SceneError.
ContactProblem read_problem(const std::filesystem::path& file);

/// Writes a local problem as FCLIB writes it, W in compressed columns, so that other solvers can read it; with
/// reactions (one a contact) a solution, too. The same problem gives the same bytes. The file appears complete or not
/// at all. Throws SceneError when the problem is empty, when its arrays disagree, or when the file cannot be written.
void write_problem(const ContactProblem& problem, const std::filesystem::path& file,
                   std::span<const Vec3> reaction = {});

/// The problem of some contacts alone (in ascending order), the others' reactions taken as zero. Exact for a region.
ContactProblem part_of(const ContactProblem& problem, std::span<const Index> contacts);

/// Separates the problem into regions and solves them from r = 0. With Friction::pyramid the errors of the solution are
/// those of the pyramid (the tangential components of the natural map clamped one by one), which is what `converged`
/// asks for. Throws SceneError when the arrays of the problem disagree or a setting is out of its range.
ProblemSolution solve_problem(const ContactProblem& problem, const ProblemSettings& settings = {});

/// |e| of docs/methods/errors.md 3 (FCLIB and Siconos, rho = 1) for given reactions, and the Coulomb gap.
struct ProblemError {
    Real absolute, relative, over_q;
    Real energy_gap;  // J
};
ProblemError problem_error(const ContactProblem& problem, std::span<const Vec3> reaction);

/// Nodes that do not move by their own masses alone: an impulse on one moves all of them.
struct CoupledNodes {
    std::vector<Index> node;
    std::vector<Real> inverse;  // 1/kg, by what, row by row, symmetric
};

/// Nodes of a rigid body.
struct RigidPoints {
    std::vector<Index> node;
    std::vector<Vec3> arm;                // m, from the centre of mass
    Real inverse_mass = 0;                // 1/kg
    Mat3 inverse_inertia = Mat3::Zero();  // 1/(kg m^2)
    Real radius = 0;                      // m, of a round body: its nodes, the core, are touched that far beside
    std::vector<Vec3> touch{};            // m, of a cylinder, by contact: where it is touched, from the centre of mass
};

/// Nodes of a body that moves implicitly, beside those of its motion as a whole (RigidPoints).
struct StrainedPoints {
    std::vector<Index> node;
    std::vector<Mat3> response;  // 1/kg, velocities by impulses, row by row, symmetric
};

/// Contacts between points of mass: u_i = sum_a weight[a] velocity[node[a]] + offset_i, in world axes. An impulse r_i
/// adds weight[a] inverse_mass[node[a]] r_i to the velocity of node a.
struct LumpedContacts {
    // by contact
    std::vector<std::array<Index, 4>> node;
    std::vector<std::array<Real, 4>> weight;
    std::vector<Vec3> normal;    // unit
    std::vector<Vec3> offset;    // m/s: what gaps leave and colliders bring, less half of what a step turns the slip by
    std::vector<Real> friction;  // mu
    // by node
    std::vector<Real> inverse_mass;  // 1/kg, 0: moved by no impulse
    std::vector<Vec3> velocity;      // m/s, without the contacts
    // nodes of these have no use for inverse_mass, but that it is not 0
    std::vector<CoupledNodes> coupled{};
    std::vector<RigidPoints> rigid{};
    std::vector<StrainedPoints> strained{};
};

/// The same as general blocks: the frame of a contact is its normal and two tangents that depend on the normal alone,
/// right-handed. Every contact needs a node that moves.
ContactProblem assemble_problem(const LumpedContacts& contacts, const std::string& name);

/// A world vector of each contact in its frame.
std::vector<Vec3> in_contact_frames(const LumpedContacts& contacts, std::span<const Vec3> vectors);

/// The contact problem of one step of a world, as its solver got it, and the impulses that the step went on with.
/// Contacts that nothing could move are left out.
struct StepProblem {
    std::uint64_t step = 0;      // number of the step, from 1
    Real time = 0;               // s, at its start
    Real step_size = 0;          // s
    LumpedContacts lumped;       // as the step has it
    ContactProblem problem;      // as general blocks
    std::vector<Vec3> impulse;   // N s, in the frames of the problem
    std::vector<Index> contact;  // by contact of the problem: its place in World::contacts()
    std::vector<Index> region;   // by contact of the problem
};

}  // namespace skerry
#pragma GCC visibility pop
