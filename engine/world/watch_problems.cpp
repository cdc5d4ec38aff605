// Contact problems for whoever wants to look at them: other solvers, mostly.
#include <algorithm>
#include <functional>
#include <string>
#include <utility>

#include "engine/problem/step_problem.h"
#include "engine/world/world_state.h"

namespace skerry {

namespace {

void copy(std::span<const Vec3> from, Column<Vec3>& to) {
    to.resize(from.size());
    std::copy(from.begin(), from.end(), to.begin());
}

}  // namespace

void keep_velocities(std::span<const Vec3> velocity, std::span<const Vec3> velocity_next, KeptVelocities& kept) {
    copy(velocity, kept.velocity);
    copy(velocity_next, kept.velocity_next);
}

void show_contact_problem(const WorldState& world, Real time) {
    if (!world.problem_watch.wants(world.counters.steps) || world.contacts.size() == 0) return;
    const ContactTable& c = world.contacts;
    const KeptVelocities& kept = world.kept_velocities;
    StepProblem problem =
        step_problem({world.region_inputs(kept.velocity), kept.velocity_next, c.impulse, c.region}, world.step.solver, world.step.h);
    if (problem.problem.q.empty()) return;
    problem.step = world.counters.steps;
    problem.time = time;
    problem.step_size = world.step.h;
    problem.problem.name = "step " + std::to_string(problem.step);
    const std::function<void(const StepProblem&)> take = world.problem_watch.take;  // a copy: it may stop the watch
    take(problem);
}

void World::watch_contact_problems(std::function<void(const StepProblem&)> take, std::uint64_t every) {
    if (every == 0)
        Complaint{
            .file = {}, .object = "watch_contact_problems", .field = "every", .found = "0", .expected = "a number of steps", .hint = {}}
            .raise();
    state_->problem_watch = {std::move(take), every};
}

}  // namespace skerry
