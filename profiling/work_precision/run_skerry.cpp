#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "engine/world/tuning.h"
#include "profiling/measure.h"
#include "profiling/work_precision/runs.h"
#include "skerry/world.h"

namespace skerry::profiling {
namespace {

struct Built {
    World world;
    std::vector<BodyHandle> bodies;
};

/// Adds a rigid sphere with the total mass of its nodes.
BodyHandle add_sphere(World& world, const PrecisionScene& scene, const PrecisionBody& body) {
    MaterialSettings material = scene.material;
    const Real volume = 4 * std::numbers::pi / 3 * std::pow(body.sphere, 3);
    material.density = std::accumulate(body.mass.begin(), body.mass.end(), 0.0) / volume;
    return world.add_body(Sphere{body.sphere}, {.material = world.add_material(material),
                                                .position = body.mesh.nodes[0],
                                                .contact_distance = scene.contact_distance,
                                                .dynamics = BodyDynamics::rigid});
}

Built build(const PrecisionScene& scene, const SkerryVariant& variant, Real step) {
    Settings settings = variant.settings;
    settings.gravity = scene.gravity.front().gravity;
    settings.backend = Backend::serial;
    settings.sleep = false;  // as in the peers
    if (step > 0) settings.step_size = step;
    Built built{tuned_world(settings, variant.tuning), {}};
    World& world = built.world;
    const MaterialHandle material = world.add_material(scene.material);
    for (const PrecisionBody& body : scene.bodies) {
        if (body.sphere > 0) {
            built.bodies.push_back(add_sphere(world, scene, body));
            continue;
        }
        const BodyHandle handle = world.add_body(body.mesh, {.material = material,
                                                             .contact_distance = scene.contact_distance,
                                                             .dynamics = variant.dynamics,
                                                             .element = scene.element});
        world.set_velocities(handle, body.velocity);
        if (!body.fixed.empty()) world.attach(handle, body.fixed);
        built.bodies.push_back(handle);
    }
    // A body keeps half its contact distance from a collider; the plane is moved by the other half.
    for (const PrecisionPlane& plane : scene.planes)
        world.add_collider(
            Plane{.normal = plane.normal, .point = plane.point + scene.contact_distance / 2 * plane.normal});
    return built;
}

Vec3 gravity_at(const PrecisionScene& scene, Real time) {
    const std::vector<GravityKey>& keys = scene.gravity;
    if (time <= keys.front().time) return keys.front().gravity;
    for (std::size_t k = 1; k < keys.size(); ++k)
        if (time < keys[k].time) {
            const Real share = (time - keys[k - 1].time) / (keys[k].time - keys[k - 1].time);
            return (1 - share) * keys[k - 1].gravity + share * keys[k].gravity;
        }
    return keys.back().gravity;
}

void sample(const Built& built, Record& record) {
    std::vector<Vec3> x, v;
    for (const BodyHandle body : built.bodies) {
        const auto position = built.world.positions(body), velocity = built.world.velocities(body);
        x.insert(x.end(), position.begin(), position.end());
        v.insert(v.end(), velocity.begin(), velocity.end());
    }
    record.positions.push_back(std::move(x));
    record.velocities.push_back(std::move(v));
}

/// Interval at which a changing gravity is updated [s].
constexpr Real gravity_interval = 2e-3;

Record run_once(const PrecisionScene& scene, const SkerryVariant& variant, Real step, double cap) {
    Built built = build(scene, variant, step);
    Record record;
    record.finished = true;
    const Real interval = scene.seconds / scene.samples;
    const int parts = scene.gravity.size() > 1 ? static_cast<int>(std::ceil(interval / gravity_interval)) : 1;
    for (int s = 0; s < scene.samples && record.finished; ++s) {
        const double start = cpu_seconds();
        for (int p = 0; p < parts && record.finished; ++p) {
            if (parts > 1) built.world.set_gravity(gravity_at(scene, s * interval + (p + 0.5) * interval / parts));
            const StepReport report = built.world.advance(interval / parts);
            record.finished = report.ok();
            record.steps += report.steps;
            record.step = report.step_size;
        }
        record.seconds += cpu_seconds() - start;
        sample(built, record);
        if (record.seconds > cap) record.finished = false;
    }
    return record;
}

}  // namespace

std::vector<SkerryVariant> time_variants() {
    const auto variant = [](std::string name, Integrator integrator, Real tolerance) {
        SkerryVariant added{.name = std::move(name), .settings = {}};
        added.settings.integrator = integrator;
        added.settings.tolerance = tolerance;
        added.settings.max_iterations = 20000;
        return added;
    };
    return {variant("symplectic Euler 1e-3", Integrator::symplectic_euler, 1e-3),
            variant("leapfrog 1e-3", Integrator::leapfrog, 1e-3), variant("leapfrog 1e-8", Integrator::leapfrog, 1e-8)};
}

Real stable_step_of(const PrecisionScene& scene) {
    return build(scene, {}, 0).world.stable_step();
}

Record run_skerry(const PrecisionScene& scene, const SkerryVariant& variant, Real step, int repeat, double cap) {
    Record record = run_once(scene, variant, step, cap);
    std::vector<double> seconds{record.seconds};
    for (int r = 1; r < repeat && record.finished; ++r) seconds.push_back(run_once(scene, variant, step, cap).seconds);
    record.seconds = median(std::move(seconds));
    return record;
}

}  // namespace skerry::profiling
