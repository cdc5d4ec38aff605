// Random shots of bodies at targets, and of targets at bodies.
#pragma once

#include <random>
#include <sstream>

#include "systems/geometry/closest_points.h"
#include "systems/geometry/rotation.h"
#include "tests/support/jittered_box.h"
#include "tests/support/surfaces_cross.h"
#include "tests/support/worlds.h"

namespace skerry::test::shots {

inline constexpr std::uint64_t seed = 20261121;

/// Uniform in [0, 1).
inline Real fraction(std::mt19937_64& random) {
    return (uniform(random) + 1) / 2;
}

inline Vec3 random_direction(std::mt19937_64& random) {
    for (;;) {
        const Vec3 v = random_vector(random);
        if (v.norm() > 0.1 && v.norm() < 1) return v.normalized();
    }
}

struct NamedMesh {
    std::string name;
    Mesh mesh;
};

inline Mesh single_tetrahedron(Real size) {
    Mesh mesh;
    mesh.nodes = {{0, 0, 0}, {size, 0, 0}, {0, size, 0}, {0, 0, size}};
    for (Vec3& x : mesh.nodes) x -= Vec3::Constant(size / 4);
    mesh.tetrahedra = {{0, 1, 2, 3}};
    return mesh;
}

inline NamedMesh random_shot(std::mt19937_64& random) {
    const Real size = 0.02 + 0.03 * fraction(random);  // size across [m]
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

/// A target around the origin with its front towards +z.
struct Target {
    std::string name;
    Mesh mesh;                       // empty for a collider
    SurfaceMesh surface;             // surface of a collider; for an analytic shape it lies a little inside
    bool held = false;               // true if the rim is held
    Real aim = 0.03;                 // largest distance of the aim from the axis [m]
    Real steepest = 60;              // largest angle of a shot from the axis [degrees]
    Real reach = 0.03;               // extent along the axis [m]
    std::optional<Shape> shape{};    // shape of an analytic collider
    Mat3 turned = Mat3::Identity();  // rotation from the frame of the shape
};

inline SurfaceMesh pyramid(const Vec3& half, bool ridge) {
    // A ridge along x, or a point, above a base.
    const Real top = ridge ? half.x() : 0.2 * half.x();
    const Mesh solid = mesh::box({2, 2, 2}, {1, 1, 1});
    SurfaceMesh surface = mesh::boundary(solid);
    for (Vec3& x : surface.nodes) {
        const bool up = x.z() > 0;
        x = Vec3(x.x() * (up ? top : half.x()), x.y() * (up ? 0.02 : 1) * half.y(), (up ? 0 : -1) * half.z());
    }
    return surface;
}

inline Target random_target(std::mt19937_64& random) {
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

/// The surface that a line of (distance from the axis, height) sweeps about the z axis. The line begins and ends on the
/// axis and has the outside on its right.
inline SurfaceMesh revolved(const std::vector<std::array<Real, 2>>& line, Index around) {
    SurfaceMesh surface;
    surface.nodes = {{0, 0, line.front()[1]}, {0, 0, line.back()[1]}};
    const auto rings = static_cast<Index>(line.size()) - 2;
    const auto node = [&](Index ring, Index i) { return 2 + ring * around + i % around; };
    for (Index ring = 0; ring < rings; ++ring)
        for (Index i = 0; i < around; ++i) {
            const auto& [r, z] = line[static_cast<std::size_t>(ring) + 1];
            const Real angle = 2 * std::acos(-1.0) * i / around;
            surface.nodes.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
        }
    for (Index i = 0; i < around; ++i) {
        surface.triangles.push_back({0, node(0, i + 1), node(0, i)});
        for (Index ring = 0; ring + 1 < rings; ++ring) {
            surface.triangles.push_back({node(ring, i), node(ring, i + 1), node(ring + 1, i)});
            surface.triangles.push_back({node(ring, i + 1), node(ring + 1, i + 1), node(ring + 1, i)});
        }
        surface.triangles.push_back({1, node(rings - 1, i), node(rings - 1, i + 1)});
    }
    return surface;
}

/// A capsule about z; a ball if `length` is 0.
inline SurfaceMesh revolved_capsule(Real radius, Real length, Index around) {
    std::vector<std::array<Real, 2>> line;
    constexpr int steps = 8;
    for (const int end : {-1, 1})
        for (int i = 0; i <= steps; ++i) {
            if (length == 0 && end == 1 && i == 0) continue;
            const Real angle = std::acos(-1.0) / 2 * (end < 0 ? i - steps : i) / steps;
            line.push_back({radius * std::cos(angle), radius * std::sin(angle) + end * length / 2});
        }
    return revolved(line, around);
}

inline SurfaceMesh revolved_cylinder(Real radius, Real height, Index around) {
    return revolved({{0, -height / 2}, {radius, -height / 2}, {radius, height / 2}, {0, height / 2}}, around);
}

inline SurfaceMesh revolved_bucket(const Bucket& bucket, Real within, Index around) {
    const Real inner = bucket.radius + within, outer = bucket.radius + bucket.thickness - within,
               rim = bucket.height - within;
    return revolved({{0, -bucket.thickness + within},
                     {outer, -bucket.thickness + within},
                     {outer, rim},
                     {inner, rim},
                     {inner, -within},
                     {0, -within}},
                    around);
}

/// Analytic colliders, above all thin and sharp ones. Their surfaces lie inside them by 5 to 10 % of the thickness.
inline Target random_shape(std::mt19937_64& random) {
    const Mat3 lying = rotation_matrix(Vec3(std::acos(-1.0) / 2, 0, 0));
    const auto target = [](const char* name, const Shape& shape, SurfaceMesh surface, Real aim, Real steepest,
                           Real reach, const Mat3& turned = Mat3::Identity()) {
        return Target{name, {}, std::move(surface), false, aim, steepest, reach, shape, turned};
    };
    const auto box = [](const Vec3& size) {
        return mesh::boundary(mesh::box(size - Vec3::Constant(0.1 * size.minCoeff()), {1, 1, 1}));
    };
    switch (static_cast<int>(9 * fraction(random))) {
        case 0:
            return target("rod", Capsule{0.001, 0.1}, revolved_capsule(0.0009, 0.1, 24), 0.01, 70, 0.001, lying);
        case 1:
            return target("needle", Capsule{0.0005, 0.06}, revolved_capsule(0.00045, 0.06, 24), 0.005, 60, 0.0305);
        case 2: {
            const Vec3 size(0.08, 0.001, 0.08);
            return target("plate, edge on", Box{size}, box(size), 0.02, 70, 0.04);
        }
        case 3: {
            const Vec3 size(0.12, 0.12, 0.001);
            return target("plate", Box{size}, box(size), 0.04, 60, 0.0005);
        }
        case 4: {
            const Vec3 size(0.06, 0.06, 0.06), on_corner(std::acos(-1.0) / 4, std::atan(std::sqrt(0.5)), 0);
            const Mat3 turned =
                rotation_matrix(Vec3(0, -on_corner.y(), 0)) * rotation_matrix(Vec3(on_corner.x(), 0, 0));
            return target("corner", Box{size}, box(size), 0.01, 40, 0.052, turned);
        }
        case 5:
            return target("bead", Sphere{0.002}, revolved_capsule(0.0018, 0, 24), 0.004, 80, 0.002);
        case 6:
            return target("disc, edge on", Cylinder{0.04, 0.001}, revolved_cylinder(0.0399, 0.0008, 48), 0.01, 70, 0.04,
                          lying);
        case 7: {
            const Bucket bucket{0.04, 0.05, 0.001};
            return target("rim", bucket, revolved_bucket(bucket, 0.0001, 64), 0.04, 50, 0.05);
        }
        default: {
            const Bucket bucket{0.04, 0.06, 0.001};
            return target("wall", bucket, revolved_bucket(bucket, 0.0001, 64), 0.02, 50, 0.041, lying);
        }
    }
}

struct Outcome {
    std::string description;
    std::string failure;  // empty if the shot was stopped
    WorldReport report;
};

/// The flying object: the shot, or a collider towards it whose velocity is set anew before every advance.
enum class Flying { shot, collider };

/// Targets to draw from: all of random_target, its colliders only, or analytic colliders.
enum class Targets { all, surfaces, shapes };

inline Target random_target(std::mt19937_64& random, Targets targets) {
    if (targets == Targets::shapes) return random_shape(random);
    for (;;) {
        Target target = random_target(random);
        if (targets == Targets::all || target.mesh.nodes.empty()) return target;
    }
}

/// Kinds of shot: deformable meshes, rigid spheres, or rigid capsules and cylinders that spin.
enum class Bullets { meshes, spheres, capsules, cylinders };

/// True if a point of a triangle lies in a cylinder by more than rounding: the part of the triangle between the ends,
/// projected along the axis, comes closer to the axis than the radius.
inline bool is_in_cylinder(const std::array<Vec3, 3>& triangle, const Vec3& middle, const Vec3& axis, Real radius,
                           Real half) {
    constexpr Real shrink = 1 - 1e-9;
    std::vector<Vec3> polygon(triangle.begin(), triangle.end());
    for (Vec3& p : polygon) p -= middle;
    for (const Real up : {-1.0, 1.0}) {
        std::vector<Vec3> clipped;
        for (std::size_t k = 0; k < polygon.size(); ++k) {
            const Vec3 &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
            const Real at = shrink * half - up * axis.dot(a), next = shrink * half - up * axis.dot(b);
            if (at > 0) clipped.push_back(a);
            if ((at > 0) != (next > 0)) clipped.push_back(a + at / (at - next) * (b - a));
        }
        polygon = std::move(clipped);
    }
    for (Vec3& p : polygon) p -= axis.dot(p) * axis;
    for (std::size_t k = 1; k + 1 < polygon.size(); ++k)
        if (closest_point_on_triangle(Vec3::Zero(), polygon[0], polygon[k], polygon[k + 1]).distance_squared <
            shrink * shrink * radius * radius)
            return true;
    return false;
}

/// One shot. All of its properties follow from its number.
class Shot {
public:
    Shot(std::uint64_t number, bool continuous, Flying flying, Targets targets, Bullets bullets)
        : random_(seed + number), world_(settings(continuous)), flying_(flying), bullets_(bullets) {
        shot_ = bullets == Bullets::meshes     ? random_shot(random_)
                : bullets == Bullets::spheres  ? NamedMesh{"sphere", {}}
                : bullets == Bullets::capsules ? NamedMesh{"capsule", {}}
                                               : NamedMesh{"cylinder", {}};
        target_ = random_target(random_, targets);
        if (bullets != Bullets::meshes) radius_ = 0.002 * std::pow(20.0, fraction(random_));
        if (bullets == Bullets::capsules) length_ = radius_ * 0.5 * std::pow(10.0, fraction(random_));
        if (bullets == Bullets::cylinders) length_ = radius_ * 0.2 * std::pow(40.0, fraction(random_));
        if (bullets != Bullets::meshes && !target_.mesh.nodes.empty() && !target_.held)
            target_dynamics_ = fraction(random_) < 0.3 ? BodyDynamics::rigid : BodyDynamics::explicit_elastic;
        frame_ = rotation_matrix(std::acos(-1.0) * fraction(random_) * random_direction(random_));
        speed_ = 3 * std::pow(100.0 / 3, fraction(random_));
        const Real shot_modulus = std::pow(10.0, 4.7 + 4.3 * fraction(random_)),
                   target_modulus = std::pow(10.0, 4.7 + 4.3 * fraction(random_));
        build(shot_modulus, target_modulus);
        std::ostringstream text;
        text << "shot " << number << ": " << shot_.name << " (E " << shot_modulus << " Pa, " << radius_ << " m) at "
             << speed_ << " m/s onto " << target_.name << " (E " << target_modulus << " Pa)";
        outcome_.description = text.str();
    }

    Outcome fly() {
        // A shot moves by less than a sixth of its radius between two checks, so that no crossing goes unseen. The time
        // is long enough for the shot to arrive, to be stopped and to leave again.
        const Real interval = 0.15 * radius_ / speed_;
        const Real end = 2 * (start_ + 4 * radius_) / speed_;
        for (Real t = 0; t < end && outcome_.failure.empty(); t += interval) {
            if (flying_ == Flying::collider) control();
            const StepReport report = world_.advance(interval);
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

    void build(Real shot_modulus, Real target_modulus) {
        const auto shot_material = world_.add_material(
            {.young_modulus = shot_modulus, .poisson_ratio = 0.3, .friction = 0.6 * fraction(random_)});
        const auto target_material =
            world_.add_material({.young_modulus = target_modulus, .poisson_ratio = 0.3, .friction = 0.3});
        if (target_.mesh.nodes.empty()) {
            ColliderSettings placed;
            placed.rotation = rotation_vector(frame_ * target_.turned);
            collider_ = world_.add_collider(target_.shape ? *target_.shape : Shape(target_.surface), placed);
            faces_ = target_.surface.triangles;
        } else {
            target_body_ = world_.add_body(target_.mesh, {.material = target_material,
                                                          .rotation = rotation_vector(frame_),
                                                          .dynamics = target_dynamics_,
                                                          .name = "target"});
            if (target_.held) hold_rim();
            faces_.assign(world_.surface(target_body_).begin(), world_.surface(target_body_).end());
        }
        for (const Vec3& x : shot_.mesh.nodes) radius_ = std::max(radius_, x.norm());
        const Real tilt = target_.steepest / 180 * std::acos(-1.0) * fraction(random_),
                   turn = 2 * std::acos(-1.0) * fraction(random_);
        const Vec3 toward_shot(std::sin(tilt) * std::cos(turn), std::sin(tilt) * std::sin(turn), std::cos(tilt));
        const Vec3 aim = target_.aim * Vec3(uniform(random_), uniform(random_), 0);
        start_ = (target_.reach + 1.1 * radius_ + length_ / 2) / std::cos(tilt);
        flight_ = -speed_ * (frame_ * toward_shot);
        const Vec3 spin = 0.7 * speed_ / radius_ * fraction(random_) * random_direction(random_);
        BodySettings shot{.material = shot_material,
                          .position = frame_ * (aim + start_ * toward_shot),
                          .rotation = 3 * fraction(random_) * random_direction(random_),
                          .velocity = flying_ == Flying::shot ? flight_ : Vec3::Zero(),
                          .angular_velocity = spin,
                          .name = "shot"};
        if (bullets_ != Bullets::meshes) shot.dynamics = BodyDynamics::rigid;
        shot_body_ = bullets_ == Bullets::spheres     ? world_.add_body(Sphere{radius_}, shot)
                     : bullets_ == Bullets::capsules  ? world_.add_body(Capsule{radius_, length_}, shot)
                     : bullets_ == Bullets::cylinders ? world_.add_body(Cylinder{radius_, length_}, shot)
                                                      : world_.add_body(shot_.mesh, shot);
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

    /// Sets a new velocity of the collider, a little faster or slower, and a spin.
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
        if (bullets_ == Bullets::spheres) {
            const Vec3 middle = world_.positions(shot_body_)[0];
            return std::ranges::any_of(faces_, [&](const std::array<Index, 3>& face) {
                const auto corner = [&](std::size_t k) { return target[static_cast<std::size_t>(face[k])]; };
                return closest_point_on_triangle(middle, corner(0), corner(1), corner(2)).distance_squared <
                       (1 - 1e-9) * radius_ * radius_;
            });
        }
        if (bullets_ == Bullets::capsules) {
            const Vec3 a = world_.positions(shot_body_)[0], b = world_.positions(shot_body_)[1];
            return std::ranges::any_of(faces_, [&](const std::array<Index, 3>& face) {
                const auto corner = [&](std::size_t k) { return target[static_cast<std::size_t>(face[k % 3])]; };
                const Real least = (1 - 1e-9) * radius_ * radius_;
                for (const Vec3& end : {a, b})
                    if (closest_point_on_triangle(end, corner(0), corner(1), corner(2)).distance_squared < least)
                        return true;
                for (std::size_t k = 0; k < 3; ++k)
                    if (closest_points_of_segments(a, b, corner(k), corner(k + 1)).distance_squared < least)
                        return true;
                return false;
            });
        }
        if (bullets_ == Bullets::cylinders) {
            const Vec3 middle = world_.positions(shot_body_)[0], up = world_.positions(shot_body_)[1] - middle;
            return std::ranges::any_of(faces_, [&](const std::array<Index, 3>& face) {
                const auto corner = [&](std::size_t k) { return target[static_cast<std::size_t>(face[k])]; };
                return is_in_cylinder({corner(0), corner(1), corner(2)}, middle, up.normalized(), radius_, length_ / 2);
            });
        }
        return crossings({world_.positions(shot_body_), world_.surface(shot_body_)}, {target, faces_}) > 0;
    }

    std::mt19937_64 random_;
    World world_;
    NamedMesh shot_;
    Target target_;
    Mat3 frame_;
    Flying flying_;
    Bullets bullets_;
    BodyDynamics target_dynamics_ = BodyDynamics::explicit_elastic;
    BodyHandle shot_body_, target_body_;
    ColliderHandle collider_;
    Vec3 flight_ = Vec3::Zero();               // velocity of the shot relative to the target [m/s]
    std::vector<std::array<Index, 3>> faces_;  // triangles of the target
    Real speed_ = 0, radius_ = 0, length_ = 0, start_ = 0;
    Outcome outcome_;
};

struct Count {
    std::string wrong;          // one line per failed shot
    std::uint64_t pressed = 0;  // number of failures with a penetration below seen_penetration
    std::uint64_t shots = 0, touching = 0, tests = 0, stopped = 0, crossed = 0;
};

// m, of the surfaces that are looked at in the thinnest targets, which are thinner by this on either side. Twice that
// is pushed out again.
inline constexpr Real seen_penetration = 0.2e-3;

inline Count shoot(std::uint64_t shots, bool continuous, Flying flying = Flying::shot, Targets targets = Targets::all,
                   Bullets bullets = Bullets::meshes) {
    Count count;
    for (std::uint64_t n = 0; n < shots; ++n) {
        Outcome outcome = Shot(n, continuous, flying, targets, bullets).fly();
        if (bullets != Bullets::meshes && outcome.failure.empty() && outcome.report.max_penetration > 0) {
            outcome.failure = "penetration " + std::to_string(outcome.report.max_penetration);
            count.pressed += outcome.report.max_penetration < seen_penetration;
        }
        ++count.shots;
        count.touching += outcome.report.max_contacts > 0;
        count.tests += outcome.report.crossing_tests;
        count.stopped += outcome.report.crossings_found;
        count.crossed += outcome.report.crossed;
        if (!outcome.failure.empty()) count.wrong += outcome.description + ": " + outcome.failure + "\n";
    }
    return count;
}

}  // namespace skerry::test::shots
