#include "profiling/lumped_solver.h"

#include <algorithm>

namespace skerry::profiling {
namespace {

constexpr Real step_size = 1e-3;  // without effect, since all gaps are zero [s]

}  // namespace

LumpedSolver::LumpedSolver(const LumpedContacts& contacts) : contacts_(contacts) {
    const std::size_t count = contacts.node.size();
    for (std::size_t i = 0; i < count; ++i) stencil_.push_back({contacts.node[i], contacts.weight[i]});
    for (const Vec3& offset : contacts.offset) surface_velocity_.push_back(-offset);
    none_.assign(count, 0);
    region_of_.assign(count, 0);
    push_out_.assign(contacts.velocity.size(), Vec3::Zero());
    reset();
}

void LumpedSolver::separate(ContactRegions mode) {
    separate_regions(*executor_, stencil_, contacts_.inverse_mass, NodeGroups{}, mode, separation_memory_, regions_,
                     region_of_);
}

void LumpedSolver::reset() {
    velocity_ = contacts_.velocity;
    impulse_.assign(stencil_.size(), Vec3::Zero());
}

RegionInputs LumpedSolver::inputs() const {
    return {.stencil = stencil_,
            .normal = contacts_.normal,
            .gap = none_,
            .surface_velocity = surface_velocity_,
            .static_friction = contacts_.friction,
            .dynamic_friction = contacts_.friction,
            .restitution = none_,
            .inverse_mass = contacts_.inverse_mass,
            .velocity = contacts_.velocity};
}

void LumpedSolver::solve(const SolverSettings& settings) {
    solve_regions(*executor_, inputs(), settings, step_size, memory_, regions_, outputs());
}

void LumpedSolver::solve(const SolverSettings& settings, lab::Method method) {
    lab_.solve(*executor_, inputs(), settings, method, step_size, regions_, outputs());
}

Index LumpedSolver::most_iterations() const {
    return regions_.iterations.empty() ? 0 : *std::ranges::max_element(regions_.iterations);
}

}  // namespace skerry::profiling
