// Frictional contact problems from files (FCLIB format), and their solution without a world.
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

/// A local contact problem: find the impulses (reactions) r and the relative velocities u = W r + q that satisfy
/// Coulomb's law of friction. For each contact, r and u have the components (normal N, tangent 1, tangent 2); T denotes
/// both tangents. The law, with the friction coefficient mu of the contact:
/// - The vector r lies in the friction cone |r_T| <= mu r_N.
/// - The vector (u_N + mu |u_T|, u_T) lies in the dual cone.
/// - These two vectors are orthogonal.
/// The matrix W is stored in compressed rows of 3x3 blocks.
struct ContactProblem {
    std::string name;               // name in messages and files
    std::vector<Index> row_offset;  // index of the first block of each row; contacts + 1 entries
    std::vector<Index> column;      // column of each block, ascending in each row; the diagonal block is always stored
    std::vector<Mat3> block;        // 3x3 blocks of W, row by row [1/kg]
    std::vector<Vec3> q;            // relative velocities without reactions [m/s]
    std::vector<Real> mu;           // coefficient of friction of each contact
    std::string description;        // description text of the file
    // Number of degrees of freedom of the global problem from which this local problem was computed; 0 if the problem
    // was local from the start.
    Index freedoms = 0;

    /// Number of contacts.
    Index contacts() const { return static_cast<Index>(q.size()); }
};

/// Settings of solve_problem().
struct ProblemSettings {
    SolverMethod method = SolverMethod::automatic;  // contact solver
    Friction friction = Friction::cone;             // friction law
    Real tolerance = 1e-6;                          // upper bound on ProblemSolution::error
    Index max_iterations = 100000;                  // largest number of sweeps over the contacts of a region
    // Relaxation factor of the sweeps, > 0 and < 2. Only methods that sweep use it.
    Real relaxation = 1;
};

/// Result of solve_problem(): the impulses, their errors and the effort of the solver. A region is a group of contacts
/// that no other contacts influence; each region is solved separately.
struct ProblemSolution {
    std::vector<Vec3> reaction;  // impulses in the contact frames of the problem [N s]
    Index regions = 0;           // number of regions
    Index iterations = 0;        // number of iterations of the region that needed most iterations
    // Computing time of the solve, without reading and checking the problem [s]. If the solve is short, it is repeated
    // for a better measurement, and this is the median time.
    double seconds = 0;
    // Relative error |e| / max(|q|, |r|, |u|) with the natural map residual e, as in FCLIB and Siconos.
    Real error = 0;
    Real error_absolute = 0;  // norm |e| of the natural map residual e
    Real error_over_q = 0;    // relative error |e| / |q|, with the natural map residual e
    // Violation of Coulomb's law [J]: sum of r_N u_N + mu r_N |u_T| + r_T . u_T over all contacts; 0 for an exact
    // solution.
    Real energy_gap = 0;
    Index largest_region = 0;  // number of contacts of the largest region
    Index unconverged = 0;     // number of regions that reached the iteration limit; 0 if converged
    bool converged = false;    // true if error <= tolerance
};

/// Reads the contact problem of an FCLIB file (HDF5). Throws SceneError.
///
/// - A local problem is read unchanged.
/// - A global problem is condensed to its contacts. With the mass matrix M and the velocities v of the bodies, it reads
///   M v = H r + f, u = H^T v + w. The local problem has W = H^T M^-1 H and q = H^T M^-1 f + w.
ContactProblem read_problem(const std::filesystem::path& file);

/// Writes a local problem in the format of FCLIB, with W in compressed columns, so that other solvers can read it. If
/// `reaction` is given (one vector per contact), a solution is written, too.
///
/// Equal problems give equal bytes. The file appears complete or not at all. Throws SceneError if the problem is empty,
/// if its arrays have inconsistent sizes or values out of range, or if the file cannot be written.
void write_problem(const ContactProblem& problem, const std::filesystem::path& file,
                   std::span<const Vec3> reaction = {});

/// Returns the problem of the given contacts (in ascending order) alone, as if the reactions of all other contacts were
/// zero. If the given contacts form a complete region, nothing is neglected, because other contacts do not influence
/// them. Throws SceneError.
ContactProblem part_of(const ContactProblem& problem, std::span<const Index> contacts);

/// Separates the problem into independent regions and solves each region, starting from r = 0. Throws SceneError if the
/// arrays of the problem have inconsistent sizes, or if a value or a setting is out of its range.
///
/// With Friction::pyramid the errors of the solution, and so `converged`, refer to the friction pyramid instead of the
/// cone: the natural map (docs/methods/errors.md) clamps each tangential component of r separately.
ProblemSolution solve_problem(const ContactProblem& problem, const ProblemSettings& settings = {});

/// Errors of given reactions, and their violation of Coulomb's law as an energy. The errors are defined as in FCLIB and
/// Siconos (natural map with rho = 1, docs/methods/errors.md 3).
struct ProblemError {
    Real absolute, relative, over_q;  // see error_absolute, error and error_over_q of ProblemSolution
    Real energy_gap;                  // see ProblemSolution::energy_gap [J]
};
/// Computes the errors of given reactions, one vector per contact. Throws SceneError if their number differs from the
/// number of contacts.
ProblemError problem_error(const ContactProblem& problem, std::span<const Vec3> reaction);

/// A group of nodes with a coupled mass matrix: an impulse on one node changes the velocities of all nodes of the
/// group.
struct CoupledNodes {
    std::vector<Index> node;    // numbers of the nodes
    std::vector<Real> inverse;  // inverse mass matrix, one row and column per node, row by row, symmetric [1/kg]
};

/// Rigid motion of a rigid or implicit body, and the nodes of this body that contacts touch.
struct RigidPoints {
    std::vector<Index> node;              // numbers of the nodes
    std::vector<Vec3> arm;                // node position relative to the centre of mass [m]
    Real inverse_mass = 0;                // inverse mass of the body [1/kg]
    Mat3 inverse_inertia = Mat3::Zero();  // inverse inertia tensor of the body, in world axes [1/(kg m^2)]
    // For a sphere or capsule: its radius [m]. The nodes lie at the centre of the sphere or on the axis of the capsule.
    // Contact points lie at the distance `radius` from the nodes, along the normal. 0 for other shapes.
    Real radius = 0;
    // For a cylinder: position of the contact point relative to the centre of mass [m], indexed by contact (entries of
    // contacts that do not touch this body are not used). Empty for other shapes.
    std::vector<Vec3> touch{};
};

/// Deformation of an implicit body, and the nodes of this body that contacts touch. RigidPoints describes the rigid
/// motion of the same body.
struct StrainedPoints {
    std::vector<Index> node;  // numbers of the nodes
    // Change of the velocity of a node per impulse on a node, for each pair of nodes [1/kg]: a symmetric matrix of 3x3
    // blocks, row by row.
    std::vector<Mat3> response;
};

/// Contacts between point masses, in world axes. Contact i acts on up to four nodes node[a], its stencil.
/// - Its relative velocity is u_i = sum_a weight[a] velocity[node[a]] + offset_i.
/// - Its impulse r_i adds weight[a] inverse_mass[node[a]] r_i to the velocity of node[a].
struct LumpedContacts {
    // The following arrays have one entry per contact.
    std::vector<std::array<Index, 4>> node;   // nodes of the stencil
    std::vector<std::array<Real, 4>> weight;  // signed weights of these nodes in the relative velocity
    std::vector<Vec3> normal;                 // unit normal of the contact
    // Velocity offset of the contact [m/s]. It is the sum of
    // - three velocities, due to the gap, the motion of the collider, and the angular velocity of round bodies,
    // - a correction that makes friction act along the sliding direction at the middle of the step. The forces of the
    //   step change the sliding velocity; the correction is minus half of the part of this change that is perpendicular
    //   to the sliding direction.
    std::vector<Vec3> offset;
    std::vector<Real> friction;  // coefficient of friction mu
    // The following arrays have one entry per node.
    std::vector<Real> inverse_mass;  // inverse mass; 0 if no impulse moves the node [1/kg]
    std::vector<Vec3> velocity;      // velocity before the contact impulses [m/s]
    // A node in one of the following lists has the inverse mass that this list gives. Its entry in inverse_mass is not
    // used, but must not be 0, because 0 would mark the node as immovable.
    std::vector<CoupledNodes> coupled{};     // groups of nodes with a common mass matrix
    std::vector<RigidPoints> rigid{};        // rigid and implicit bodies
    std::vector<StrainedPoints> strained{};  // deformation of implicit bodies
};

/// Converts lumped contacts to a problem with general blocks. The frame of a contact is right-handed: its normal and
/// two tangents that depend on the normal alone. Each contact must have at least one node that can move.
ContactProblem assemble_problem(const LumpedContacts& contacts, const std::string& name);

/// Transforms one vector per contact from world axes into the frame of this contact.
std::vector<Vec3> in_contact_frames(const LumpedContacts& contacts, std::span<const Vec3> vectors);

/// The contact problem of one step of a world, as the solver received it, and the impulses that the solver found.
/// `problem` differs from the problem of the step:
/// - Contacts that no impulse can move are omitted.
/// - Each contact has only one friction coefficient. So if static friction differs from dynamic friction, or friction
///   depends on the direction, `impulse` does not solve `problem`.
/// - The constraints of joints, of weld and ball ties, and of nodes held along single directions are eliminated: W and
///   q describe the constrained bodies.
/// - Some impulses of the step are taken as given, and their effect is part of q: those of slide ties, of motors,
///   limits and passive forces of joints, and of cables with friction or a prescribed length.
struct StepProblem {
    std::uint64_t step = 0;      // number of the step, counted from 1
    Real time = 0;               // time at the start of the step [s]
    Real step_size = 0;          // length of the step [s]
    LumpedContacts lumped;       // contacts in the form that the step used; joints, ties, cables and nodes held along
                                 // single directions are left out
    ContactProblem problem;      // the contacts of `lumped` as a problem with general blocks
    std::vector<Vec3> impulse;   // impulses of the step in the contact frames of `problem` [N s]
    std::vector<Index> contact;  // index in World::contacts() of each contact of `problem`
    std::vector<Index> region;   // region number of each contact of `problem`
};

}  // namespace skerry
#pragma GCC visibility pop
