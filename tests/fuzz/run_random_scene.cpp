#include "run_random_scene.h"

#include <algorithm>
#include <ctime>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>
#include <stdexcept>

#include "check_world.h"
#include "engine/scene/scene_plan.h"
#include "random_numbers.h"

namespace skerry::test {

namespace {

double cpu_seconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

template <class Handle>
std::optional<Handle> any_of(const std::vector<Handle>& handles, RandomNumbers& random) {
    if (handles.empty()) return std::nullopt;
    return handles[random.next() % handles.size()];
}

/// Makes the changes of a scene during the run.
class Changer {
public:
    Changer(World& world, const RandomScene& scene) : world_(world), scene_(scene) {}

    void make(const SceneChange& change) {
        RandomNumbers random(change.seed);
        const std::optional<BodyHandle> body = any_of(world_.bodies(), random);
        switch (change.change) {
            case Change::remove_body:
                if (body) world_.remove(*body);
                return;
            case Change::remove_collider:
                if (const auto collider = any_of(world_.colliders(), random)) world_.remove(*collider);
                return;
            case Change::add_body:
                return add_body(random);
            case Change::add_collider:
                world_.add_collider(Sphere{scene_.length * random.by_decade(0.1, 10)},
                                    {.position = anywhere(random), .motion = {}});
                return;
            case Change::attach:
                if (body) attach(*body, random);
                return;
            case Change::detach:
                if (!attachments_.empty() && world_.alive(attachments_.back())) world_.remove(attachments_.back());
                return;
            case Change::set_velocities:
                if (body) set_velocities(*body, random);
                return;
            case Change::set_loads:
                if (body) set_loads(*body, random);
                return;
            case Change::set_gravity:
                world_.set_gravity(random.within(0, 100) * random.direction());
                return;
        }
    }

private:
    Vec3 anywhere(RandomNumbers& random) {
        const std::optional<BodyHandle> beside = any_of(world_.bodies(), random);
        const Vec3 center = beside ? world_.center_of_mass(*beside) : Vec3(Vec3::Zero());
        return center + scene_.length * random.within(0, 3) * random.direction();
    }

    void add_body(RandomNumbers& random) {
        // The softest material of the scenes, and light, so that the step of the others need not shrink.
        const MaterialHandle material =
            world_.add_material({.young_modulus = 1e3, .poisson_ratio = 0.3, .density = 1000, .friction = 0});
        const Mesh mesh = random.chance(0.5) ? mesh::ball(scene_.length / 2, random.count(1, 4))
                                             : mesh::box(scene_.length * Vec3::Ones(), {2, 1, 3});
        BodySettings body{.material = material,
                          .position = anywhere(random),
                          .velocity = random.within(0, scene_.speed) * random.direction(),
                          .self_contact = random.chance(0.5)};
        if (!body.self_contact && random.chance(0.4)) {
            body.dynamics = BodyDynamics::rigid;
            if (random.chance(0.5))
                world_.add_body(Sphere{scene_.length / 2}, body);
            else
                world_.add_body(Capsule{scene_.length / 4, scene_.length / 2}, body);
        } else {
            world_.add_body(mesh, body);
        }
    }

    void attach(BodyHandle body, RandomNumbers& random) {
        if (world_.dynamics(body) != BodyDynamics::explicit_elastic) return;
        const auto count = static_cast<int>(world_.positions(body).size());
        std::vector<Index> nodes(static_cast<std::size_t>(random.count(1, count)));
        std::iota(nodes.begin(), nodes.end(), 0);
        Motion motion;
        if (random.chance(0.5)) motion.velocity = random.within(0, scene_.speed) * random.direction();
        attachments_.push_back(world_.attach(body, nodes, motion, world_.center_of_mass(body)));
    }

    void set_velocities(BodyHandle body, RandomNumbers& random) {
        std::vector<Vec3> velocity(world_.positions(body).size());
        for (Vec3& v : velocity) v = random.within(0, scene_.speed) * random.direction();
        world_.set_velocities(body, velocity);
    }

    void set_loads(BodyHandle body, RandomNumbers& random) {
        const Real weight = world_.mass(body) * 9.81 / static_cast<Real>(world_.positions(body).size());
        std::vector<Vec3> load(world_.positions(body).size());
        for (Vec3& f : load) f = random.by_decade(0.01, 100) * weight * random.direction();
        world_.set_loads(body, load);
    }

    World& world_;
    const RandomScene& scene_;
    std::vector<AttachmentHandle> attachments_;
};

/// Largest allowed growth factor of the energy. It covers symplectic Euler's error near the stability limit and
/// contacts that are pushed apart in between. An instability grows by orders of magnitude.
constexpr Real most_growth = 3;

/// Error of a region from which it counts as unsolved. Zero impulses have an error of about 1.
constexpr Real as_good_as_unsolved = 0.5;

/// Watches the energy of a scene in which only gravity does work.
class EnergyWatch {
public:
    EnergyWatch(const World& world, Real length) : start_(world.energy()) {
        for (const BodyHandle body : world.bodies()) mass_ += world.mass(body);
        // Speed gained by falling for one stable step: the order of symplectic Euler's error in a gravity field.
        const Real fall = world.settings().gravity.norm() * world.stable_step();
        // Rounding of strains, relative to the energy at a strain of one.
        const Real sound = length / world.stable_step();
        floor_ = mass_ * (10 * fall * fall + 1e-20 * sound * sound);
    }

    Real start() const { return start_.kinetic + start_.elastic + floor_; }
    /// Ratio of the mechanical energy to that of the start.
    Real growth(const Energy& now) const {
        const Real begun = start();
        const Real gained = now.kinetic + now.elastic + now.potential - start_.potential;
        // Potential energies are small differences of large numbers far from the origin.
        const Real rounding = 1e-12 * (std::abs(now.potential) + std::abs(start_.potential));
        return begun > 0 ? std::max(Real(0), gained - rounding) / begun : 0;
    }

private:
    Energy start_;
    Real mass_ = 0, floor_ = 0;
};

/// Distance that colliders are moved [m]. A plane that is swept past a body can be that deep in it.
Real way_of_colliders(const RandomScene& scene) {
    const nlohmann::json json = nlohmann::json::parse(scene.json);
    const auto vector = [](const nlohmann::json& v) {
        return Vec3(v.at(0).get<Real>(), v.at(1).get<Real>(), v.at(2).get<Real>());
    };
    Real way = 0;
    for (const auto& collider : json.value("colliders", nlohmann::json::array())) {
        if (!collider.contains("motion")) continue;
        const auto& motion = collider["motion"];
        if (motion.contains("velocity")) way += json.at("seconds").get<Real>() * vector(motion["velocity"]).norm();
        if (!motion.contains("keys")) continue;
        const auto& keys = motion["keys"];
        for (std::size_t k = 1; k < keys.size(); ++k)
            way += (vector(keys[k]["position"]) - vector(keys[k - 1]["position"])).norm();
    }
    return way;
}

/// Diameter of all bodies plus the size of the largest collider, a bound on depths in the world [m]
Real extent_of(const World& world, const RandomScene& scene) {
    Vec3 lower = Vec3::Constant(1e300), upper = -lower;
    for (const BodyHandle body : world.bodies())
        for (const Vec3& x : world.positions(body)) lower = lower.cwiseMin(x), upper = upper.cwiseMax(x);
    const Real bodies = world.bodies().empty() ? 0 : (upper - lower).norm();
    return bodies + 100 * scene.length;  // the size of the largest collider
}

}  // namespace

SceneRun run_random_scene(const RandomScene& scene, const std::filesystem::path& folder,
                          const SceneOverrides& overrides, double seconds) {
    const std::filesystem::path file = write_random_scene(scene, folder, "scene.json");
    const double start = cpu_seconds();
    const auto time_is_left = [&](const StepReport&) { return cpu_seconds() - start <= seconds; };
    SceneRun run;
    std::optional<Scene> built;
    try {
        ScenePlan plan = plan_scene(file, overrides);
        plan.tuning = scene.tuning;
        built.emplace(build_scene(plan));
    } catch (const SceneError& error) {
        run.end = SceneEnd::refused;
        run.message = error.what();
        return run;
    }
    World& world = built->world;
    check_bodies(world);
    const EnergyWatch energy(world, scene.length);
    const Real way = way_of_colliders(scene);
    bool passive = scene.passive;
    Changer changer(world, scene);
    std::size_t next_change = 0;
    for (int a = 0; a < scene.advances; ++a) {
        for (; next_change < scene.changes.size() && scene.changes[next_change].advance == a; ++next_change)
            changer.make(scene.changes[next_change]);
        const Real step = world.stable_step();
        const Real before = world.time(), dt = std::isfinite(step) ? scene.steps_per_advance * step : 1e-3;
        StepReport report;
        try {
            report = world.advance(dt, time_is_left);
        } catch (const SceneError& error) {  // an added object overlaps something and has no way out
            run.end = SceneEnd::refused;
            run.message = error.what();
            break;
        }
        run.steps += static_cast<std::uint64_t>(report.steps);
        run.max_contacts = std::max(run.max_contacts, report.contacts);
        // A turning plane sweeps over everything. In a step of a large turn it can come down on a body anywhere, so any
        // depth is valid then. The report names the plane.
        constexpr Real resolved_turn = 0.25;  // turn in one step [rad]
        const bool swept = world.report().collider_turn > resolved_turn;
        check_report(report, swept ? std::numeric_limits<Real>::infinity() : extent_of(world, scene) + way);
        check_bodies(world);
        check_contacts(world);
        const bool stopped = report.status == StepStatus::stopped;
        if (!report.ok() && !stopped) {
            run.end = SceneEnd::refused;
            run.message = report.message();
            break;
        }
        if (!stopped && world.time() != before + dt) throw std::runtime_error("time went wrong");
        // Contacts that overlap at the start are pushed out, which adds energy.
        passive &= next_change == 0 && !(a == 0 && report.max_gap_violation > 0);
        // A method that leaves contacts unsolved lets bodies overlap; the report says so, and pushing out adds energy.
        passive &= !(report.worst_error > as_good_as_unsolved);
        if (passive) run.energy_growth = std::max(run.energy_growth, energy.growth(world.energy()));
        if (run.energy_growth > most_growth)
            throw std::runtime_error("energy out of nothing: " + std::to_string(run.energy_growth) + " times the " +
                                     std::to_string(energy.start()) + " J of the start");
        if (stopped) {
            run.end = SceneEnd::cut_short;
            break;
        }
    }
    run.hash = world.state_hash();
    run.energy_error_share = world.report().energy_error_share;
    return run;
}

}  // namespace skerry::test
