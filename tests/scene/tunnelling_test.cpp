// Shots at up to 100 m/s: nothing goes through anything.
#include <catch2/catch.hpp>
#include <sstream>

#include "systems/geometry/rotation.h"
#include "tests/support/jittered_box.h"
#include "tests/support/surfaces_cross.h"
#include "tests/support/worlds.h"

using namespace skerry;
using namespace skerry::test;

namespace {

constexpr std::uint64_t seed = 20261121;

/// Uniform in [0, 1).
Real fraction(std::mt19937_64& random) {
    return (uniform(random) + 1) / 2;
}

Vec3 random_direction(std::mt19937_64& random) {
    for (;;) {
        const Vec3 v = random_vector(random);
        if (v.norm() > 0.1 && v.norm() < 1) return v.normalized();
    }
}

struct Named {
    std::string name;
    Mesh mesh;
};

Mesh single_tetrahedron(Real size) {
    Mesh mesh;
    mesh.nodes = {{0, 0, 0}, {size, 0, 0}, {0, size, 0}, {0, 0, size}};
    for (Vec3& x : mesh.nodes) x -= Vec3::Constant(size / 4);
    mesh.tetrahedra = {{0, 1, 2, 3}};
    return mesh;
}

Named random_shot(std::mt19937_64& random) {
    const Real size = 0.02 + 0.03 * fraction(random);  // m, across
    switch (static_cast<int>(5 * fraction(random))) {
        case 0:
            return {"ball of 160", mesh::ball(size / 2, 4)};
        case 1:
            return {"ball of 20", mesh::ball(size / 2, 2)};
        case 2:
            return {"box of 6", mesh::box(Vec3(1, 0.6, 0.4) * size, {1, 1, 1})};
        case 3:
            return {"box of 48", mesh::box(Vec3(1, 1, 1) * 0.7 * size, {2, 2, 2})};
        default:
            return {"tetrahedron", single_tetrahedron(size)};
    }
}

/// What is shot at, around the origin with its front towards +z.
struct Target {
    std::string name;
    Mesh mesh;            // empty: a mesh collider
    SurfaceMesh surface;  // of a mesh collider
    bool held = false;    // at its rim
    Real aim = 0.03;      // m, how far from the axis shots may go
    Real steepest = 60;   // degrees from the axis
    Real reach = 0.03;    // m, along the axis
};

SurfaceMesh pyramid(const Vec3& half, bool ridge) {
    // A ridge along x, or a point, above a base below.
    const Real top = ridge ? half.x() : 0.2 * half.x();
    const Mesh solid = mesh::box({2, 2, 2}, {1, 1, 1});
    SurfaceMesh surface = mesh::boundary(solid);
    for (Vec3& x : surface.nodes) {
        const bool up = x.z() > 0;
        x = Vec3(x.x() * (up ? top : half.x()), x.y() * (up ? 0.02 : 1) * half.y(), (up ? 0 : -1) * half.z());
    }
    return surface;
}

Target random_target(std::mt19937_64& random) {
    switch (static_cast<int>(8 * fraction(random))) {
        case 0:
            return {"held sheet", mesh::box({0.2, 0.2, 0.004}, {6, 6, 1}), {}, true, 0.05, 60, 0.004};
        case 1:
            return {"fine held sheet", mesh::box({0.12, 0.12, 0.003}, {12, 12, 1}), {}, true, 0.03, 60, 0.004};
        case 2:
            return {"free sheet", mesh::box({0.16, 0.16, 0.005}, {6, 6, 1}), {}, false, 0.04, 45, 0.005};
        case 3:
            return {"sheet, edge on", mesh::box({0.004, 0.1, 0.1}, {1, 4, 4}), {}, false, 0.02, 80, 0.055};
        case 4:
            return {"ball", mesh::ball(0.03, 4), {}, false, 0.025, 80, 0.03};
        case 5:
            return {"thin mesh collider",
                    {},
                    mesh::boundary(mesh::box({0.2, 0.2, 0.002}, {3, 3, 1})),
                    false,
                    0.06,
                    70,
                    0.001};
        case 6:
            return {"ridge", {}, pyramid({0.1, 0.04, 0.05}, true), false, 0.03, 60, 0.01};
        default:
            return {"spike", {}, pyramid({0.05, 0.05, 0.06}, false), false, 0.01, 60, 0.01};
    }
}

struct Outcome {
    std::string description;
    std::string failure;  // empty: stopped
    WorldReport report;
};

/// Who flies: the shot, or a mesh collider towards it, whose velocity is set anew at every look.
enum class Flying { shot, collider };

/// One shot: everything about it follows from its number.
class Shot {
public:
    Shot(std::uint64_t number, bool continuous, Flying flying = Flying::shot)
        : random_(seed + number), world_(settings(continuous)), flying_(flying) {
        shot_ = random_shot(random_);
        do target_ = random_target(random_);
        while (flying == Flying::collider && !target_.mesh.nodes.empty());
        frame_ = rotation_matrix(std::acos(-1.0) * fraction(random_) * random_direction(random_));
        speed_ = 3 * std::pow(100.0 / 3, fraction(random_));
        const Real own = std::pow(10.0, 4.7 + 4.3 * fraction(random_)),
                   other = std::pow(10.0, 4.7 + 4.3 * fraction(random_));
        build(own, other);
        std::ostringstream text;
        text << "shot " << number << ": " << shot_.name << " (E " << own << " Pa) at " << speed_ << " m/s onto "
             << target_.name << " (E " << other << " Pa)";
        outcome_.description = text.str();
    }

    Outcome fly() {
        // A shot moves by less than a sixth of its radius between two looks: nothing goes through another unseen. Long
        // enough for the shot to come, to be stopped and to leave again.
        const Real look = 0.15 * radius_ / speed_;
        const Real end = 2 * (start_ + 4 * radius_) / speed_;
        for (Real t = 0; t < end && outcome_.failure.empty(); t += look) {
            if (flying_ == Flying::collider) control();
            const StepReport report = world_.advance(look);
            if (!report.ok()) outcome_.failure = "refused: " + report.message();
            if (overlaps()) outcome_.failure = "overlaps at " + std::to_string(world_.time()) + " s";
        }
        outcome_.report = world_.report();
        return outcome_;
    }

private:
    static Settings settings(bool continuous) {
        Settings settings;
        settings.gravity = Vec3::Zero();
        settings.backend = Backend::serial;
        settings.continuous_collision = continuous;
        return settings;
    }

    void build(Real own_modulus, Real other_modulus) {
        const auto own = world_.add_material(
            {.young_modulus = own_modulus, .poisson_ratio = 0.3, .friction = 0.6 * fraction(random_)});
        const auto other = world_.add_material({.young_modulus = other_modulus, .poisson_ratio = 0.3, .friction = 0.3});
        if (target_.mesh.nodes.empty()) {
            ColliderSettings placed;
            placed.rotation = rotation_vector(frame_);
            collider_ = world_.add_collider(target_.surface, placed);
            faces_ = target_.surface.triangles;
        } else {
            target_body_ = world_.add_body(target_.mesh,
                                           {.material = other, .rotation = rotation_vector(frame_), .name = "target"});
            if (target_.held) hold_rim();
            faces_.assign(world_.surface(target_body_).begin(), world_.surface(target_body_).end());
        }
        radius_ = 0;
        for (const Vec3& x : shot_.mesh.nodes) radius_ = std::max(radius_, x.norm());
        const Real tilt = target_.steepest / 180 * std::acos(-1.0) * fraction(random_),
                   turn = 2 * std::acos(-1.0) * fraction(random_);
        const Vec3 from(std::sin(tilt) * std::cos(turn), std::sin(tilt) * std::sin(turn), std::cos(tilt));
        const Vec3 aim = target_.aim * Vec3(uniform(random_), uniform(random_), 0);
        start_ = (target_.reach + 1.1 * radius_) / std::cos(tilt);
        flight_ = -speed_ * (frame_ * from);
        const Vec3 spin = 0.7 * speed_ / radius_ * fraction(random_) * random_direction(random_);
        shot_body_ = world_.add_body(shot_.mesh, {.material = own,
                                                  .position = frame_ * (aim + start_ * from),
                                                  .rotation = 3 * fraction(random_) * random_direction(random_),
                                                  .velocity = flying_ == Flying::shot ? flight_ : Vec3::Zero(),
                                                  .angular_velocity = spin,
                                                  .name = "shot"});
    }

    void hold_rim() {
        Vec3 half = Vec3::Zero();
        for (const Vec3& x : target_.mesh.nodes) half = half.cwiseMax(x);
        std::vector<Index> rim;
        for (std::size_t n = 0; n < target_.mesh.nodes.size(); ++n) {
            const Vec3& x = target_.mesh.nodes[n];
            if (std::abs(x.x()) > 0.999 * half.x() || std::abs(x.y()) > 0.999 * half.y())
                rim.push_back(static_cast<Index>(n));
        }
        world_.attach(target_body_, rim);
    }

    /// A little faster or slower, and turning.
    void control() {
        const Real turn = 0.1 * speed_ / radius_;
        world_.set_velocity(collider_, -(0.8 + 0.4 * fraction(random_)) * flight_,
                            turn * fraction(random_) * random_direction(random_));
    }

    std::vector<Vec3> target_positions() const {
        if (!target_.mesh.nodes.empty()) {
            const std::span<const Vec3> position = world_.positions(target_body_);
            return {position.begin(), position.end()};
        }
        const MotionKey pose = world_.pose(collider_);
        std::vector<Vec3> position;
        for (const Vec3& x : target_.surface.nodes)
            position.push_back(pose.position + rotation_matrix(pose.rotation) * x);
        return position;
    }
    bool overlaps() const {
        const std::vector<Vec3> target = target_positions();
        return crossings({world_.positions(shot_body_), world_.surface(shot_body_)}, {target, faces_}) > 0;
    }

    std::mt19937_64 random_;
    World world_;
    Named shot_;
    Target target_;
    Mat3 frame_;
    Flying flying_;
    BodyHandle shot_body_, target_body_;
    ColliderHandle collider_;
    Vec3 flight_ = Vec3::Zero();               // m/s, of the shot as seen from the target
    std::vector<std::array<Index, 3>> faces_;  // of the target
    Real speed_ = 0, radius_ = 0, start_ = 0;
    Outcome outcome_;
};

struct Count {
    std::string wrong;  // one line a shot
    std::uint64_t shots = 0, touching = 0, tests = 0, stopped = 0, crossed = 0;
};

Count shoot(std::uint64_t shots, bool continuous, Flying flying = Flying::shot) {
    Count count;
    for (std::uint64_t n = 0; n < shots; ++n) {
        const Outcome outcome = Shot(n, continuous, flying).fly();
        ++count.shots;
        count.touching += outcome.report.max_contacts > 0;
        count.tests += outcome.report.crossing_tests;
        count.stopped += outcome.report.crossings_found;
        count.crossed += outcome.report.crossed;
        if (!outcome.failure.empty()) count.wrong += outcome.description + ": " + outcome.failure + "\n";
    }
    return count;
}

}  // namespace

TEST_CASE("of 1,000 shots at up to 100 m/s all are stopped", "[scene][slow]") {
    INFO("seed " << seed);
    const Count count = shoot(1000, true);
    CHECK(count.wrong == "");
    CHECK(count.crossed == 0);
    CHECK(count.touching > 950);  // nearly all hit what they are aimed at
    CHECK(count.stopped > 1000);
}

TEST_CASE("of 1,000 mesh colliders at up to 100 m/s, whose velocity is set anew all the time, none goes through",
          "[scene][slow]") {
    INFO("seed " << seed);
    const Count count = shoot(1000, true, Flying::collider);
    CHECK(count.wrong == "");
    CHECK(count.crossed == 0);
    CHECK(count.touching > 900);
    CHECK(count.stopped > 300);
}

TEST_CASE("without the look at the motion of a step some of the shots come through", "[scene]") {
    INFO("seed " << seed);
    const Count count = shoot(100, false);
    CHECK(count.wrong != "");
    CHECK(count.tests == 0);
}
