// Solver of contacts of lumped masses. Like a step of the engine it separates regions and then runs the stage
// solve_regions.
#pragma once

#include <memory>
#include <vector>

#include "profiling/lab/region_solver.h"
#include "skerry/problem.h"
#include "systems/contact/separate_regions.h"
#include "systems/solver/solve_regions.h"

namespace skerry::profiling {

/// Solves on one thread, and from r = 0 after reset().
class LumpedSolver {
public:
    explicit LumpedSolver(const LumpedContacts& contacts);

    void separate(ContactRegions mode = ContactRegions::separate);
    /// Restores the state before a solve: impulses zero, velocities as given.
    void reset();
    void solve(const SolverSettings& settings);
    /// Solves the problem with a method of the lab.
    void solve(const SolverSettings& settings, lab::Method method);

    const std::vector<Vec3>& impulse() const { return impulse_; }  // in world axes [N s]
    const RegionTable& regions() const { return regions_; }
    Index most_iterations() const;

private:
    RegionInputs inputs() const;
    RegionOutputs outputs() { return {.impulse = impulse_, .velocity_next = velocity_, .push_out = push_out_}; }

    LumpedContacts contacts_;
    std::vector<Stencil> stencil_;
    std::vector<Vec3> surface_velocity_, impulse_, velocity_, push_out_;
    std::vector<Real> none_;  // zeros, one per contact: gap, restitution
    std::vector<Index> region_of_;
    std::unique_ptr<Executor> executor_ = make_executor(Backend::serial, 1);
    SeparationMemory separation_memory_;
    SolverMemory memory_;
    lab::RegionSolver lab_;
    RegionTable regions_;
};

}  // namespace skerry::profiling
