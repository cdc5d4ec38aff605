// Passes contact problems to subscribers, mostly for comparison with other solvers.
#include <algorithm>
#include <array>
#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "engine/problem/step_problem.h"
#include "engine/world/step/step.h"
#include "systems/contact/keep_resting_contacts.h"

namespace skerry {

namespace {

template <class T>
void copy(std::span<const T> from, Column<T>& to) {
    to.resize(from.size());
    std::copy(from.begin(), from.end(), to.begin());
}

/// Converts row numbers of the contacts of a step to positions in the list of all contacts, which includes contacts of
/// sleeping bodies.
void say_places_among_all(const ContactTable& contacts, const RestingContactTable& resting, std::vector<Index>& place) {
    if (resting.empty()) return;
    Column<Index> rows;
    merge_contacts(contacts, resting, rows);
    std::vector<Index> place_of(contacts.size());
    for (std::size_t i = 0; i < rows.size(); ++i)
        if (rows[i] >= 0) place_of[static_cast<std::size_t>(rows[i])] = static_cast<Index>(i);
    for (Index& row : place) row = place_of[static_cast<std::size_t>(row)];
}

/// Marks the contacts of all regions that also have rows of joints, ties, cables or held axes. The list is empty if
/// there are none.
std::vector<bool> joined_contacts(const Model& model, const StepScratch& scratch) {
    const CableTable& cables = model.cables;
    std::vector<bool> joined(model.bodies.slot.size(), false);  // by row of BodyTable
    const auto mark = [&](std::span<const Index> bodies) {
        for (const Index body : bodies)
            if (body != no_index) joined[static_cast<std::size_t>(body)] = true;
    };
    mark(model.joints.first.span());
    mark(model.joints.second.span());
    if (model.ties.size() > 0)
        for (const Index tie : scratch.ties.tie)
            mark(std::array{model.ties.first[static_cast<std::size_t>(tie)],
                            model.ties.second[static_cast<std::size_t>(tie)]});
    if (cables.size() > 0)
        for (const CableBlock& block : scratch.cables.solved())
            mark(rows_of(cables.anchor.body.span(), cables.points[static_cast<std::size_t>(block.cable)]));
    if (!std::ranges::all_of(model.attachments.held.span(), holds_completely))
        for (const Index entry : scratch.held_rows.entry) {
            const Index node = model.attachments.node[static_cast<std::size_t>(entry)];
            mark(std::array{model.nodes.body[static_cast<std::size_t>(node)]});
        }
    std::set<Index> regions;
    const ContactTable& c = scratch.contacts;
    for (std::size_t row = 0; row < c.size(); ++row)
        for (const Index body : {c.first_body[row], c.second_body[row]})
            if (body != no_index && joined[static_cast<std::size_t>(body)]) regions.insert(c.region[row]);
    std::vector<bool> contacts;
    if (regions.empty()) return contacts;
    for (std::size_t row = 0; row < c.size(); ++row) contacts.push_back(regions.contains(c.region[row]));
    return contacts;
}

}  // namespace

void keep_velocities(std::span<const Vec3> velocity, std::span<const Vec3> velocity_next,
                     std::span<const Vec3> position, const KeptFrames& frames, KeptVelocities& kept) {
    copy(velocity, kept.velocity);
    copy(velocity_next, kept.velocity_next);
    if (frames.center.empty()) return;
    copy(position, kept.position);
    copy(frames.center, kept.center);
    copy(frames.rotation, kept.rotation);
    copy(frames.angular_momentum, kept.angular_momentum);
    copy(frames.deforming, kept.deforming);
    copy(frames.deforming_before, kept.deforming_before);
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
    inputs.implicit.velocity = kept.deforming;
    inputs.implicit.velocity_before = kept.deforming_before;
    StepProblem problem =
        step_problem({inputs, kept.velocity_next, c.impulse, c.region, joined_contacts(model, scratch)},
                     scratch.parameters.solver, scratch.parameters.h);
    if (problem.problem.q.empty()) return;
    say_places_among_all(c, world.cache.resting, problem.contact);
    problem.step = record.counters.steps;
    problem.time = time;
    problem.step_size = scratch.parameters.h;
    problem.problem.name = "step " + std::to_string(problem.step);
    // The function is copied, because its call may end the subscription.
    const std::function<void(const StepProblem&)> take = record.problem_watch.take;
    take(problem);
}

void World::watch_contact_problems(std::function<void(const StepProblem&)> take, std::uint64_t every) {
    if (every == 0)
        Complaint{.file = {},
                  .object = "watch_contact_problems",
                  .field = "every",
                  .found = "0",
                  .expected = "a number of steps >= 1",
                  .hint = {}}
            .raise();
    state_->record.problem_watch = {std::move(take), every};
}

}  // namespace skerry
