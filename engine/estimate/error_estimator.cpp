#include <algorithm>
#include <functional>
#include <map>

#include "engine/estimate/contact_area.h"
#include "engine/estimate/contact_error.h"
#include "engine/estimate/mesh_error.h"
#include "engine/estimate/step_error.h"
#include "engine/world/elements_of_body.h"
#include "engine/world/kernels.h"
#include "engine/world/world_state.h"
#include "skerry/estimate.h"

namespace skerry {

namespace {

/// Errors of the meshes of all bodies, each at the sample with the largest elastic energy of the body.
class MeshErrors {
public:
    /// Takes a sample of the bodies with the most elastic energy, at least of one. `fraction`: upper limit of the
    /// number of sampled tetrahedra, as a fraction of all tetrahedra. `last`: also samples sleeping bodies that were
    /// not sampled before.
    void sample(const World& world, Real fraction, bool last) {
        const Model& model = WorldAccess::state_of(world).model;
        struct Strained {
            BodyHandle body;
            std::size_t row;
            Real energy;
        };
        std::vector<Strained> strained;
        Real remaining_tetrahedra = 0;  // number of tetrahedra that may still be sampled
        for (const BodyHandle body : world.bodies()) {
            const auto row = static_cast<std::size_t>(model.row(body, "ErrorEstimator::sample"));
            remaining_tetrahedra += fraction * model.bodies.tetrahedron_count[row];
            if (model.bodies.asleep[row] != 0 && !(last && !found_.contains(body))) continue;
            const ElementsOfBody elements(model, row);
            if (elements.blocks.size() > 0)
                strained.push_back(
                    {body, row, kernels().elastic_energy(elements.elements, elements.blocks, elements.position)});
        }
        std::ranges::stable_sort(strained, std::greater(), &Strained::energy);
        for (const auto& [body, row, energy] : strained) {
            remaining_tetrahedra -= model.bodies.tetrahedron_count[row];
            if (remaining_tetrahedra < 0 && body != strained.front().body) return;
            add(measure_mesh_error(world, body), body, model.yields(row), world.time());
        }
    }

    void add_to(std::vector<ErrorEstimate>& bodies) const {
        for (ErrorEstimate& body : bodies) {
            const auto found = found_.find(body.body);
            if (found == found_.end()) continue;
            body.mesh = found->second.mesh;
            body.deflection = found->second.deflection;
            body.interpolation = found->second.interpolation;
            body.stress = found->second.stress;
            body.worst_tetrahedron = found->second.worst;
            body.time = found->second.time;
        }
    }

private:
    struct Found {
        Real stored, mesh, deflection, interpolation, stress;
        Index worst;
        Real time;
    };

    void add(const MeshError& error, BodyHandle body, bool yields, Real time) {
        if (!(error.stored > (found_.contains(body) ? found_[body].stored : 0))) return;
        const std::vector<Real> relative = error.relative_errors();
        found_[body] = {.stored = error.stored,
                        .mesh = error.mesh(),
                        .deflection = yields ? not_estimated : error.deflection(),
                        .interpolation = error.interpolation,
                        .stress = error.stress,
                        .worst = static_cast<Index>(std::ranges::max_element(relative) - relative.begin()),
                        .time = time};
    }

    std::map<BodyHandle, Found> found_;
};

/// Intervals between samples, as numbers of steps in which something moved. All samples together take less than 2 % of
/// the computing time of the steps.
struct Pace {
    // number of steps before the first sample of all meshes; the sample takes 0.6 % of the computing time of these
    // steps
    std::uint64_t first_mesh;
    std::uint64_t mesh;    // number of steps between samples of meshes
    std::uint64_t motion;  // number of steps between samples of motion and contacts
};
Pace pace_of(const World& world) {
    constexpr Pace explicit_pace{8000, 2000, 200}, implicit_pace{250, 100, 20};
    const Model& model = WorldAccess::state_of(world).model;
    // Worlds without explicit bodies take few, long steps, so they are sampled after fewer steps.
    return model.all_blocks().size() == 0 ? implicit_pace : explicit_pace;
}

}  // namespace

struct ErrorEstimator::Impl {
    MeshErrors mesh;
    StepError step;
    ContactError contact;
    ContactArea area;
    std::vector<ErrorEstimate> bodies;
    // Values of steps_of(): when the estimator was made, at the last sample of meshes, and at the last sample of motion
    // and contacts.
    std::uint64_t start = 0, mesh_steps = 0, motion_steps = 0;
    bool has_moved = false;  // true if something moved between the last two samples of motion

    /// Number of steps in which something moved, since the world was made.
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
    impl_->start = impl_->mesh_steps = Impl::steps_of(world);
    impl_->sample_motion(world);
}
ErrorEstimator::~ErrorEstimator() = default;
ErrorEstimator::ErrorEstimator(ErrorEstimator&&) noexcept = default;
ErrorEstimator& ErrorEstimator::operator=(ErrorEstimator&&) noexcept = default;

void ErrorEstimator::sample(const World& world) {
    const Pace pace = pace_of(world);
    const std::uint64_t steps = Impl::steps_of(world);
    const bool starts = !impl_->has_moved && steps > impl_->motion_steps;
    if (starts || steps - impl_->motion_steps >= pace.motion) impl_->sample_motion(world);
    if (steps - impl_->start < pace.first_mesh || steps - impl_->mesh_steps < pace.mesh) return;
    impl_->mesh_steps = steps;
    impl_->mesh.sample(world, 1, false);
}

void ErrorEstimator::finish(const World& world) {
    impl_->sample_motion(world);
    const auto steps = static_cast<Real>(Impl::steps_of(world) - impl_->start);
    impl_->mesh.sample(world, std::min<Real>(1, steps / static_cast<Real>(pace_of(world).first_mesh)), true);
    impl_->list(world);
}

std::vector<ErrorEstimate> ErrorEstimator::bodies() const {
    return impl_->bodies;
}

}  // namespace skerry
