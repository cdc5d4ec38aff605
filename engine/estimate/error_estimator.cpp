#include <algorithm>
#include <cmath>
#include <map>

#include "engine/estimate/contact_area.h"
#include "engine/estimate/contact_error.h"
#include "engine/estimate/mesh_error.h"
#include "engine/estimate/step_error.h"
#include "engine/world/world_state.h"
#include "skerry/estimate.h"

namespace skerry {

namespace {

/// Errors of the meshes of all bodies, each at the sample with the largest elastic energy of the body.
class MeshErrors {
public:
    /// `all`: also samples sleeping bodies that were not sampled before.
    void sample(const World& world, bool all) {
        const Model& model = WorldAccess::state_of(world).model;
        for (const BodyHandle handle : world.bodies()) {
            const auto body = static_cast<std::size_t>(model.row(handle, "ErrorEstimator::sample"));
            const bool is_new = !found_.contains(handle);
            if (model.bodies.asleep[body] != 0 && !(all && is_new)) continue;
            const MeshError error = measure_mesh_error(world, handle);
            if (!(error.stored > (is_new ? 0 : found_[handle].stored))) continue;
            found_[handle] = {.stored = error.stored,
                              .mesh = error.mesh(),
                              .deflection = model.yields(body) ? not_estimated : error.deflection(),
                              .stress = error.stress,
                              .worst = static_cast<Index>(std::ranges::max_element(error.error) - error.error.begin()),
                              .time = world.time()};
        }
    }

    void add_to(std::vector<ErrorEstimate>& bodies) const {
        for (ErrorEstimate& body : bodies) {
            const auto found = found_.find(body.body);
            if (found == found_.end()) continue;
            body.mesh = found->second.mesh;
            body.deflection = found->second.deflection;
            body.stress = found->second.stress;
            body.worst_tetrahedron = found->second.worst;
            body.time = found->second.time;
        }
    }

private:
    struct Found {
        Real stored, mesh, deflection, stress;
        Index worst;
        Real time;
    };
    std::map<BodyHandle, Found> found_;
};

}  // namespace

struct ErrorEstimator::Impl {
    MeshErrors mesh;
    StepError step;
    ContactError contact;
    ContactArea area;
    std::vector<ErrorEstimate> bodies;
    // Steps in which something moved, at the last sample of the mesh, and at the last sample of motion and contacts.
    std::uint64_t steps = 0, motion_steps = 0;
    bool has_moved = false;  // true after the first sample with motion

    /// Steps in which something moved, since the world was made.
    static std::uint64_t steps_of(const World& world) {
        const RunCounters& counters = WorldAccess::state_of(world).record.counters;
        return counters.steps - counters.resting_steps;
    }

    void sample_motion(const World& world) {
        has_moved = steps_of(world) > motion_steps;
        motion_steps = steps_of(world);
        step.sample(world);
        contact.sample(world);
        area.sample(world);
    }
    void sample_mesh(const World& world, bool last) {
        steps = steps_of(world);
        mesh.sample(world, last);
    }
    void list(const World& world) {
        bodies.clear();
        for (const BodyHandle body : world.bodies()) bodies.push_back({.body = body, .name = world.name(body)});
        mesh.add_to(bodies);
        step.add_to(bodies);
        contact.add_to(bodies);
        area.add_to(bodies);
    }
};

ErrorEstimator::ErrorEstimator(const World& world) : impl_(std::make_unique<Impl>()) {
    impl_->steps = Impl::steps_of(world);
    impl_->sample_motion(world);
}
ErrorEstimator::~ErrorEstimator() = default;
ErrorEstimator::ErrorEstimator(ErrorEstimator&&) noexcept = default;
ErrorEstimator& ErrorEstimator::operator=(ErrorEstimator&&) noexcept = default;

void ErrorEstimator::sample(const World& world) {
    // A sample of the mesh takes the computing time of about ten explicit steps, and that of less than one implicit
    // step. A sample of motion and contacts takes that of half an explicit step, and of a fifth of an implicit one.
    constexpr std::uint64_t explicit_steps = 1000, implicit_steps = 50, explicit_motion = 50, implicit_motion = 20;
    const bool is_implicit = WorldAccess::state_of(world).model.implicit_nodes.displacement.size() > 0;
    const std::uint64_t steps = Impl::steps_of(world);
    const bool starts = !impl_->has_moved && steps > impl_->motion_steps;
    const bool moved = steps - impl_->motion_steps >= (is_implicit ? implicit_motion : explicit_motion);
    const bool deformed = steps - impl_->steps >= (is_implicit ? implicit_steps : explicit_steps);
    if (starts || moved) impl_->sample_motion(world);
    if (deformed) impl_->sample_mesh(world, false);
    if (starts || moved || deformed) impl_->list(world);
}

void ErrorEstimator::finish(const World& world) {
    impl_->sample_motion(world);
    impl_->sample_mesh(world, true);
    impl_->list(world);
}

std::vector<ErrorEstimate> ErrorEstimator::bodies() const {
    return impl_->bodies;
}

}  // namespace skerry
