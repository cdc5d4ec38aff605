// A rollout gives the bits of a loop over clones that runs on one thread, on any number of threads.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>

#include "skerry/joint.h"
#include "skerry/rollout.h"

namespace skerry::test::rollout_test {

namespace {

/// Two fingers beside a soft ball on a plane, a held bar, and a rigid box on a hinge with a motor.
struct Bench {
    World world;
    MaterialHandle rubber;
    BodyHandle ball, bar, lever;
    std::array<ColliderHandle, 2> finger;
    AttachmentHandle clamp;
    JointHandle hinge;

    explicit Bench(const Settings& settings = {}) : world(settings) {
        rubber = world.add_material({.young_modulus = 5e4, .density = 500, .friction = 0.8, .damping = 20});
        world.add_collider(Plane{});
        ball = world.add_body(mesh::ball(0.05, 4), {.material = rubber, .position = {0, 0, 0.052}, .name = "ball"});
        for (std::size_t i = 0; i < 2; ++i)
            finger[i] = world.add_collider(Box{{0.02, 0.04, 0.04}},
                                           {.position = {i == 1 ? 0.065 : -0.065, 0, 0.05}, .name = "finger"});
        bar = world.add_body(mesh::box({0.2, 0.05, 0.05}, {8, 2, 2}),
                             {.material = rubber, .position = {0, 0.5, 0.5}, .name = "bar"});
        std::vector<Index> left;
        for (std::size_t n = 0; n < world.positions(bar).size(); ++n)
            if (world.positions(bar)[n].x() < -0.099) left.push_back(static_cast<Index>(n));
        clamp = world.attach(bar, left);
        lever = world.add_body(
            mesh::box({0.1, 0.02, 0.02}, {2, 1, 1}),
            {.material = rubber, .position = {0, -0.5, 0.5}, .dynamics = BodyDynamics::rigid, .name = "lever"});
        hinge = Joints(world).add({.kind = JointKind::hinge,
                                   .first = lever,
                                   .point = {-0.05, -0.5, 0.5},
                                   .axis = {0, 1, 0},
                                   .motor = JointMotor{.speed = 0, .strength = 5}});
    }

    std::vector<RecordedProbe> probes() const {
        return {{"tip", probe_point(world, bar, {0.1, 0.5, 0.5})},
                {"ball", BodyProbe{ball}},
                {"grip", BodyForceProbe{ball, finger[1]}},
                {"right", ColliderForceProbe{finger[1]}},
                {"clamp", ReactionProbe{clamp}},
                {"hinge", JointProbe{hinge}},
                {"energy", EnergyProbe{}},
                {"stress", StressProbe{bar}},
                {"volume", VolumeProbe{ball}},
                {"pose", PoseProbe{ball}},
                {"finger", PoseProbe{finger[0]}},
                {"twist", VelocityProbe{lever}},
                {"shape", NodesProbe{ball}}};
    }
};

constexpr std::size_t world_count = 6, interval_count = 12;
constexpr Real dt = 5e-3;

/// Values of all controls, which differ from world to world and from interval to interval.
struct Commands {
    std::vector<Real> left, right, clamp, motor, load, gravity;

    explicit Commands(const Bench& bench) {
        const std::size_t nodes = bench.world.positions(bench.bar).size();
        for (std::size_t w = 0; w < world_count; ++w)
            for (std::size_t i = 0; i < interval_count; ++i) {
                const Real a = static_cast<Real>(w), t = static_cast<Real>(i + 1);
                left.insert(left.end(), {-0.065 + 1e-3 * t, 1e-4 * a, 0.05, 0, 0, 0.01 * a});
                right.insert(right.end(), {-0.1 - 0.05 * a, 0, 0, 0, 0.1 * a, 0});
                clamp.insert(clamp.end(), {1e-3 * a * t, 0, 0, 0, 0, 0.01 * t});
                motor.push_back(a - 0.5 * t);
                for (std::size_t n = 0; n < nodes; ++n) load.insert(load.end(), {0, 0, 1e-3 * (a - 2)});
            }
        for (std::size_t i = 0; i < interval_count; ++i)  // the same for all worlds
            gravity.insert(gravity.end(), {0.1 * static_cast<Real>(i), 0, -9.81});
    }

    std::vector<RolloutControl> controls(const Bench& bench) const {
        return {{PoseControl{bench.finger[0]}, left}, {VelocityControl{bench.finger[1]}, right},
                {PoseControl{bench.clamp}, clamp},    {MotorSpeedControl{bench.hinge}, motor},
                {NodeForceControl{bench.bar}, load},  {GravityControl{}, gravity}};
    }
};

/// Rows and state of one world that a loop drives through all intervals.
struct Looped {
    std::vector<Real> rows;
    std::uint64_t hash;
};

Vec3 vector_at(const std::vector<Real>& values, std::size_t place) {
    return {values[3 * place], values[3 * place + 1], values[3 * place + 2]};
}

Looped loop(const Bench& bench, const Commands& commands, std::size_t w) {
    World world = bench.world.clone({.threads = 1});
    MaterialSettings material = world.material(bench.rubber);
    material.friction = 0.1 * static_cast<Real>(w);
    world.set_material(bench.rubber, material);
    Recorder recorder(world, bench.probes());
    const std::size_t nodes = world.positions(bench.bar).size();
    Looped looped;
    for (std::size_t i = 0; i < interval_count; ++i) {
        const std::size_t place = w * interval_count + i;
        world.move_to(bench.finger[0], {vector_at(commands.left, 2 * place), vector_at(commands.left, 2 * place + 1)},
                      dt);
        world.set_velocity(bench.finger[1], vector_at(commands.right, 2 * place),
                           vector_at(commands.right, 2 * place + 1));
        world.move_to(bench.clamp, {vector_at(commands.clamp, 2 * place), vector_at(commands.clamp, 2 * place + 1)},
                      dt);
        Joints(world).set_motor(bench.hinge, JointMotor{.speed = commands.motor[place], .strength = 5});
        std::vector<Vec3> load;
        for (std::size_t n = 0; n < nodes; ++n) load.push_back(vector_at(commands.load, place * nodes + n));
        world.set_loads(bench.bar, load);
        world.set_gravity(vector_at(commands.gravity, i));
        REQUIRE(world.advance(dt).ok());
        recorder.sample(world);
        const auto row = recorder.row(recorder.row_count() - 1);
        looped.rows.insert(looped.rows.end(), row.begin(), row.end());
    }
    looped.hash = world.state_hash();
    return looped;
}

bool same_bits(Real a, Real b) {
    return std::memcmp(&a, &b, sizeof a) == 0;
}

/// Compares the arrays of a rollout with the rows of loops, number by number.
void check_rows(const RolloutResult& result, const std::vector<Looped>& looped) {
    std::size_t columns = 1, different = 0, finite = 0;
    for (const RolloutSeries& series : result.series) columns += series.columns.size();
    for (std::size_t w = 0; w < world_count; ++w) {
        REQUIRE(looped[w].rows.size() == interval_count * columns);
        for (std::size_t i = 0; i < interval_count; ++i) {
            std::size_t c = i * columns;
            const std::size_t place = w * interval_count + i;
            different += !same_bits(result.time[place], looped[w].rows[c++]);
            for (const RolloutSeries& series : result.series)
                for (std::size_t k = 0; k < series.columns.size(); ++k, ++c) {
                    const Real value = series.values[place * series.columns.size() + k];
                    different += !same_bits(value, looped[w].rows[c]);
                    finite += std::isfinite(value);
                }
        }
    }
    CHECK(different == 0);
    CHECK(finite > world_count * interval_count * (columns - 40));
}

}  // namespace

TEST_CASE("a rollout on 1, 2, 5 and 14 threads has the bits of a loop over clones", "[determinism]") {
    const Bench bench;
    const Commands commands(bench);
    std::vector<Looped> looped;
    for (std::size_t w = 0; w < world_count; ++w) looped.push_back(loop(bench, commands, w));
    CHECK(looped[0].hash != looped[1].hash);
    const std::uint64_t before = bench.world.state_hash();
    for (const int threads : {1, 2, 5, 14}) {  // 14 threads are two for each world
        CAPTURE(threads);
        const RolloutResult result = rollout(bench.world, world_count,
                                             {.intervals = interval_count,
                                              .dt = dt,
                                              .controls = commands.controls(bench),
                                              .record = bench.probes(),
                                              .threads = threads,
                                              .keep_worlds = true,
                                              .prepare = [&](World& copy, std::size_t w) {
                                                  MaterialSettings material = copy.material(bench.rubber);
                                                  material.friction = 0.1 * static_cast<Real>(w);
                                                  copy.set_material(bench.rubber, material);
                                              }});
        check_rows(result, looped);
        REQUIRE(result.worlds.size() == world_count);
        for (std::size_t w = 0; w < world_count; ++w) {
            CHECK(result.status[w].ok());
            CHECK(result.status[w].intervals == interval_count);
            CHECK(result.worlds[w].state_hash() == looped[w].hash);
            CHECK(result.worlds[w].settings().threads == (threads == 14 ? 2 : 1));
        }
    }
    CHECK(bench.world.state_hash() == before);
    CHECK_FALSE(bench.world.measures_forces());
}

TEST_CASE("a rollout that goes on from the final worlds of the first half has the bits of the whole", "[determinism]") {
    const Bench bench;
    const std::vector<Real> left(6 * interval_count, 0.01);
    const std::vector<RolloutControl> controls{{VelocityControl{bench.finger[0]}, left}};
    const auto run = [&](std::span<const World* const> worlds, std::size_t intervals) {
        return rollout(worlds, {.intervals = intervals,
                                .dt = dt,
                                .controls = {{VelocityControl{bench.finger[0]}, std::span(left).first(6 * intervals)}},
                                .threads = 2,
                                .keep_worlds = true});
    };
    const std::vector<const World*> start(3, &bench.world);
    const RolloutResult whole = run(start, interval_count), half = run(start, interval_count / 2);
    std::vector<const World*> middle;
    for (const World& world : half.worlds) middle.push_back(&world);
    const RolloutResult end = run(middle, interval_count - interval_count / 2);
    for (std::size_t w = 0; w < 3; ++w) {
        CHECK(end.worlds[w].state_hash() == whole.worlds[w].state_hash());
        CHECK(end.time.back() == whole.time.back());
    }
}

}  // namespace skerry::test::rollout_test
