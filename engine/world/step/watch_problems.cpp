// Passes the contact problem of a step (the equations that the contact solver solves, and the impulses that it finds)
// to a subscriber, mostly for comparison with other solvers.
#include <algorithm>
#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/complaint.h"
#include "engine/problem/step_problem.h"
#include "engine/world/step/step.h"
#include "systems/contact/keep_resting_contacts.h"

namespace skerry {

namespace {

template <class T>
void keep_column(std::span<const T> from, Column<T>& to) {
    to.resize(from.size());
    std::copy(from.begin(), from.end(), to.begin());
}

/// The entries of `contact_indices` are rows of `contacts`. Replaces each of them by the index of the contact in the
/// list that World::contacts() returns. This list is longer, because it also contains contacts of sleeping bodies.
void number_as_in_view(const ContactTable& contacts, const RestingContactTable& resting,
                       std::vector<Index>& contact_indices) {
    if (resting.empty()) return;
    Column<Index> rows;
    merge_contacts(contacts, resting, rows);
    std::vector<Index> index_of(contacts.size());
    for (std::size_t i = 0; i < rows.size(); ++i)
        if (rows[i] >= 0) index_of[static_cast<std::size_t>(rows[i])] = static_cast<Index>(i);
    for (Index& row : contact_indices) row = index_of[static_cast<std::size_t>(row)];
}

/// Returns the directions along which attachments hold nodes. `entries`: indices in AttachmentTable::node of the nodes
/// to include: those that belong to a contact region of the step.
std::vector<HeldDirection> held_directions(const AttachmentTable& attachments, std::span<const Index> entries) {
    std::vector<HeldDirection> held;
    if (entries.empty()) return held;
    const std::set<Index> in_regions(entries.begin(), entries.end());
    for (std::size_t a = 0; a < attachments.held.size(); ++a)
        for (Index i = attachments.nodes[a].begin; i < attachments.nodes[a].end; ++i)
            for (const Vec3 direction : attachments.held[a].colwise())
                if (in_regions.contains(i) && !direction.isZero(0)) held.push_back({attachments.node[i], direction});
    return held;
}

}  // namespace

void keep_velocities(std::span<const Vec3> velocity, std::span<const Vec3> velocity_next,
                     std::span<const Vec3> position, const KeptFrames& frames, KeptVelocities& kept) {
    keep_column(velocity, kept.velocity);
    keep_column(velocity_next, kept.velocity_next);
    if (frames.center.empty()) return;
    keep_column(position, kept.position);
    keep_column(frames.center, kept.center);
    keep_column(frames.rotation, kept.rotation);
    keep_column(frames.axes, kept.axes);
    keep_column(frames.angular_momentum, kept.angular_momentum);
    keep_column(frames.deforming, kept.deforming);
    keep_column(frames.deforming_before, kept.deforming_before);
}

void show_contact_problem(const WorldState& world, Real time) {
    const Model& model = world.model;
    const StepScratch& scratch = world.scratch;
    const RunRecord& record = world.record;
    if (!record.problem_watch.wants(record.counters.steps) || scratch.contacts.size() == 0) return;
    const ContactTable& c = scratch.contacts;
    const KeptVelocities& kept = scratch.kept_velocities;
    RegionInputs inputs =
        RegionInputs::bind({}, c, model.nodes, kept.velocity, scratch.parameters.collision.gravity, model.clusters,
                           scratch.cluster_kick, model.bodies, model.rigid_bodies, model.implicit_nodes,
                           scratch.coupling, scratch.joints, scratch.cables, model.surface_sets);
    inputs.rigid.position = kept.position;
    inputs.rigid.center = kept.center;
    inputs.rigid.spins.angular_momentum = kept.angular_momentum;
    inputs.implicit.rotation = kept.rotation;
    inputs.implicit.axes = kept.axes;
    inputs.implicit.velocity = kept.deforming;
    inputs.implicit.velocity_before = kept.deforming_before;
    const bool any_held = !std::ranges::all_of(model.attachments.held.span(), holds_completely);
    const StepEquations equations{
        scratch.joints, scratch.ties, model.ties.kind.span(), scratch.cables,
        held_directions(model.attachments, any_held ? scratch.held_rows.entry.span() : std::span<const Index>())};
    StepProblem problem = step_problem({inputs, kept.velocity_next, c.impulse, c.region, equations},
                                       scratch.parameters.solver, scratch.parameters.h);
    if (problem.problem.q.empty()) return;
    number_as_in_view(c, world.cache.resting, problem.contact);
    problem.step = record.counters.steps;
    problem.time = time;
    problem.step_size = scratch.parameters.h;
    problem.problem.name = "step " + std::to_string(problem.step);
    // The function is copied, because it may end its own subscription while it runs.
    const std::function<void(const StepProblem&)> take = record.problem_watch.take;
    take(problem);
}

void World::watch_contact_problems(std::function<void(const StepProblem&)> take, std::uint64_t every) {
    if (every == 0) refuse("watch_contact_problems", "every", "0", "a number of steps >= 1");
    state_->record.problem_watch = {std::move(take), every};
}

}  // namespace skerry
