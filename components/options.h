// Options that a user selects by name. EnumNames lists the names of each enum. The scene reader, the help of the
// program and the reports use this list only.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <utility>

namespace skerry {

/// Material laws (docs/methods/elasticity.md 2). Near the rest shape all isotropic laws agree with Hooke's law.
enum class MaterialModel {
    linear,              // Hooke's law of small strain, for small rotations only
    corotational,        // Hooke's law of small strain, relative to the mean rotation of the element
    stable_neo_hookean,  // for large strain; the energy is finite even for inverted elements (Smith et al. 2018)
    ogden,               // for rubber at large strain (Ogden 1972); see MaterialSettings::terms
    orthotropic,         // for wood and composites at strains of some per cent; see MaterialSettings::orthotropic
    hencky,              // for logarithmic strain; the only law with plasticity, see MaterialSettings::plasticity
    guard,               // the inversion barrier of docs/methods/elasticity.md 7.7; materials cannot have this law
};
/// Elements that compute the stress of a body (docs/methods/elasticity.md 7).
enum class ElementKind {
    linear,         // tetrahedra with constant strain, which lock in bending and in nearly incompressible materials
    smoothed,       // edge_smoothed up to a Poisson ratio of 0.25, edge_node_smoothed above
    edge_smoothed,  // one element per edge, with the mean strain of the tetrahedra around the edge
    edge_node_smoothed,  // elements at edges for the shear stress, elements at nodes for the volumetric stress
};
/// Friction laws.
enum class Friction {
    cone,     // Coulomb's friction cone
    pyramid,  // approximation of the cone with four sides (Lazarevych et al. 2010; docs/methods/friction.md 1.3)
};
/// Division of contacts into regions.
enum class ContactRegions {
    separate,  // contacts that do not influence each other are solved separately
    global,    // all contacts form one region
};
/// Contact solvers (docs/solvers.md, docs/methods/region_solver.md).
enum class SolverMethod {
    automatic,  // ags; for rigid and implicit bodies also Newton steps where they are cheaper
    ags,        // accelerated block Gauss-Seidel sweeps
    pgs,        // block Gauss-Seidel sweeps without acceleration
    pcg_pgs,    // Algorithm 2 of Lazarevych et al. (2010): first projected conjugate gradients, then sweeps
    newton,     // semismooth Newton's method with a dense matrix
    pcg_fr,     // only the conjugate gradients of pcg_pgs, with the formula of Fletcher and Reeves
    pcg_pr,     // only the conjugate gradients of pcg_pgs, with the formula of Polak and Ribiere
};
/// Libraries that run the tasks of a step on several threads.
enum class Backend {
    tbb,        // oneTBB
    openmp,     // OpenMP
    threads,    // threads of the C++ standard library
    serial,     // no library: the calling thread runs all tasks
    automatic,  // the first backend of this list that this build contains
};
/// Initial contact impulses of the solver (docs/methods/region_solver.md 7).
enum class WarmStart {
    off,  // zero
    on,   // the impulses of the last step
};
/// Treatment of new bodies that overlap other bodies or colliders. The next call of World::advance applies it before
/// its first step (docs/decisions/0017-start-overlaps.md).
enum class StartOverlaps {
    resolve,  // moves the bodies apart without adding energy; refuses them if no short displacement suffices
    refuse,   // refuses the bodies
    ignore,   // reports the overlaps and starts the simulation with them
};
/// Kind of overlap of two objects.
enum class OverlapKind {
    crossing,    // their surfaces intersect
    inside,      // the first object is inside the second
    around,      // the second object is inside the first
    coincident,  // each object is inside the other
};
/// Time integrators (docs/step_length.md). Both alternate a kick, in which forces change velocities, and a drift, in
/// which velocities change positions.
enum class Integrator {
    // First order in the step length, because given velocities count as those of half a step before the start. The
    // energy error stays bounded.
    symplectic_euler,
    // Second order in smooth motion, because forces are computed at the positions in the middle of each step. Each call
    // of World::advance therefore moves the positions forward by half a step before the first step, and back after the
    // last one.
    leapfrog,
};

template <class Enum>
struct EnumNames;

template <>
struct EnumNames<MaterialModel> {
    static constexpr std::array<std::pair<MaterialModel, std::string_view>, 6> table{{
        {MaterialModel::linear, "linear"},
        {MaterialModel::corotational, "corotational"},
        {MaterialModel::stable_neo_hookean, "stable_neo_hookean"},
        {MaterialModel::ogden, "ogden"},
        {MaterialModel::orthotropic, "orthotropic"},
        {MaterialModel::hencky, "hencky"},
    }};
};
template <>
struct EnumNames<ElementKind> {
    static constexpr std::array<std::pair<ElementKind, std::string_view>, 4> table{{
        {ElementKind::linear, "linear"},
        {ElementKind::smoothed, "smoothed"},
        {ElementKind::edge_smoothed, "edge_smoothed"},
        {ElementKind::edge_node_smoothed, "edge_node_smoothed"},
    }};
};
template <>
struct EnumNames<Friction> {
    static constexpr std::array<std::pair<Friction, std::string_view>, 2> table{{
        {Friction::cone, "cone"},
        {Friction::pyramid, "pyramid"},
    }};
};
template <>
struct EnumNames<ContactRegions> {
    static constexpr std::array<std::pair<ContactRegions, std::string_view>, 2> table{{
        {ContactRegions::separate, "separate"},
        {ContactRegions::global, "global"},
    }};
};
template <>
struct EnumNames<SolverMethod> {
    static constexpr std::array<std::pair<SolverMethod, std::string_view>, 7> table{{
        {SolverMethod::automatic, "automatic"},
        {SolverMethod::ags, "ags"},
        {SolverMethod::pgs, "pgs"},
        {SolverMethod::pcg_pgs, "pcg_pgs"},
        {SolverMethod::newton, "newton"},
        {SolverMethod::pcg_fr, "pcg_fr"},
        {SolverMethod::pcg_pr, "pcg_pr"},
    }};
};
template <>
struct EnumNames<Backend> {
    static constexpr std::array<std::pair<Backend, std::string_view>, 5> table{{
        {Backend::tbb, "tbb"},
        {Backend::openmp, "openmp"},
        {Backend::threads, "threads"},
        {Backend::serial, "serial"},
        {Backend::automatic, "automatic"},
    }};
};
template <>
struct EnumNames<WarmStart> {
    static constexpr std::array<std::pair<WarmStart, std::string_view>, 2> table{{
        {WarmStart::off, "off"},
        {WarmStart::on, "on"},
    }};
};

template <>
struct EnumNames<StartOverlaps> {
    static constexpr std::array<std::pair<StartOverlaps, std::string_view>, 3> table{{
        {StartOverlaps::resolve, "resolve"},
        {StartOverlaps::refuse, "refuse"},
        {StartOverlaps::ignore, "ignore"},
    }};
};
template <>
struct EnumNames<OverlapKind> {
    static constexpr std::array<std::pair<OverlapKind, std::string_view>, 4> table{{
        {OverlapKind::crossing, "crossing"},
        {OverlapKind::inside, "inside"},
        {OverlapKind::around, "around"},
        {OverlapKind::coincident, "coincident"},
    }};
};

template <>
struct EnumNames<Integrator> {
    static constexpr std::array<std::pair<Integrator, std::string_view>, 2> table{{
        {Integrator::symplectic_euler, "symplectic_euler"},
        {Integrator::leapfrog, "leapfrog"},
    }};
};

/// Option names of earlier versions, each with a hint for users who still write it.
template <class Enum>
struct RemovedNames {
    static constexpr std::array<std::pair<std::string_view, std::string_view>, 0> table{};
};
template <>
struct RemovedNames<Friction> {
    static constexpr std::array<std::pair<std::string_view, std::string_view>, 1> table{{
        {"cone_convex", "use \"cone\"; cone_convex is available only in profile_solvers, for comparison"},
    }};
};
template <>
struct RemovedNames<ContactRegions> {
    static constexpr std::array<std::pair<std::string_view, std::string_view>, 1> table{{
        {"paper_algorithm_1",
         "use \"separate\"; paper_algorithm_1 is available only in profile_separation, for comparison"},
    }};
};
template <>
struct RemovedNames<Integrator> {
    static constexpr std::array<std::pair<std::string_view, std::string_view>, 1> table{{
        {"forward_euler", "use \"symplectic_euler\" (the default) or \"leapfrog\"; forward Euler is never stable"},
    }};
};
template <>
struct RemovedNames<SolverMethod> {
    static constexpr std::array<std::pair<std::string_view, std::string_view>, 3> table{{
        {"nncg", "use \"automatic\" or \"ags\"; nncg is available only in profile_solvers, for comparison"},
        {"apgd", "use \"automatic\" or \"ags\"; apgd is available only in profile_solvers, for comparison"},
        {"mprgp", "use \"automatic\" or \"ags\"; mprgp is available only in profile_solvers, for comparison"},
    }};
};

/// The name of an option value, as scenes and reports write it.
template <class Enum>
constexpr std::string_view name_of(Enum value) {
    for (const auto& [candidate, name] : EnumNames<Enum>::table)
        if (candidate == value) return name;
    return "?";
}

/// The option value with this name, or nothing if no value has the name.
template <class Enum>
constexpr std::optional<Enum> from_name(std::string_view name) {
    for (const auto& [value, candidate] : EnumNames<Enum>::table)
        if (candidate == name) return value;
    return std::nullopt;
}

/// Hint about the replacement of a removed name; empty if `name` is not a removed name.
template <class Enum>
constexpr std::string_view hint_for_removed(std::string_view name) {
    for (const auto& [removed, hint] : RemovedNames<Enum>::table)
        if (removed == name) return hint;
    return {};
}

}  // namespace skerry
