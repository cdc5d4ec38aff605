#include <Eigen/Geometry>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <stdexcept>

#include "profiling/work_precision/scene.h"

namespace skerry::profiling {
namespace {

constexpr Real g = 9.81;  // [m/s^2]

/// Moves a mesh so that its lowest node is `base` above `position`, and gives every node a velocity.
PrecisionBody make_body(Mesh mesh, const Vec3& position, Real base, const Vec3& velocity) {
    Real lowest = mesh.nodes[0].z();
    for (const Vec3& node : mesh.nodes) lowest = std::min(lowest, node.z());
    for (Vec3& node : mesh.nodes) node += Vec3(position.x(), position.y(), position.z() + base - lowest);
    PrecisionBody body{.mesh = std::move(mesh), .velocity = {}, .fixed = {}, .mass = {}};
    body.velocity.assign(body.mesh.nodes.size(), velocity);
    return body;
}

/// Turns off the losses of a material, since the peers have other kinds of losses.
void lose_nothing(MaterialSettings& material) {
    material.loss_factor = material.bulk_viscosity = 0;
}

/// A soft ball falls, is pressed flat, leaves the floor and flies up again.
PrecisionScene bounce(int level) {
    PrecisionScene scene;
    scene.material = {.young_modulus = 5e4, .poisson_ratio = 0.3, .density = 1000, .friction = 0.3};
    scene.bodies.push_back(
        make_body(mesh::ball(0.05, 2 * level), Vec3::Zero(), scene.contact_distance + 0.02, Vec3::Zero()));
    scene.planes.push_back({});
    scene.seconds = 0.3;
    scene.samples = 30;
    scene.length = 0.1;
    return scene;
}

/// A block slides on the floor until friction has stopped it: v^2 / (2 mu g) = 0.17 m in 0.34 s.
PrecisionScene slide(int level) {
    PrecisionScene scene;
    scene.material = {.young_modulus = 1e5, .poisson_ratio = 0.3, .density = 1000, .friction = 0.3};
    scene.bodies.push_back(make_body(mesh::box({0.1, 0.1, 0.05}, {2 * level, 2 * level, level}), Vec3::Zero(),
                                     scene.contact_distance, Vec3(1, 0, 0)));
    scene.planes.push_back({});
    scene.seconds = 0.4;
    scene.samples = 20;
    scene.length = 0.1;
    return scene;
}

/// A bar is held at one end and let go with a rotation about its axis that grows towards the free end. It twists to and
/// fro.
PrecisionScene twist(int level) {
    constexpr Real length = 0.3, edge = 0.05, turning = 40;  // [m], [m], [rad/s] at the free end: ~0.9 rad of twist
    PrecisionScene scene;
    scene.material = {.young_modulus = 1e5, .poisson_ratio = 0.3, .density = 1000, .friction = 0.3};
    PrecisionBody bar =
        make_body(mesh::box({edge, edge, length}, {level, level, 6 * level}), Vec3::Zero(), 0, Vec3::Zero());
    for (std::size_t n = 0; n < bar.mesh.nodes.size(); ++n) {
        const Vec3& x = bar.mesh.nodes[n];
        bar.velocity[n] = turning * x.z() / length * Vec3(-x.y(), x.x(), 0);
        if (x.z() < 1e-9) bar.fixed.push_back(static_cast<Index>(n));
    }
    scene.bodies.push_back(std::move(bar));
    scene.seconds = 0.3;
    scene.samples = 30;
    scene.length = edge;
    scene.gravity = {{0, Vec3::Zero()}};
    return scene;
}

/// A ball runs into three skittles. The time at which its trajectories diverge from those of a run that began 1e-12 m
/// elsewhere is measured, not assumed.
PrecisionScene skittles(int level) {
    PrecisionScene scene;
    scene.material = {.young_modulus = 6e4, .poisson_ratio = 0.35, .density = 300, .friction = 0.4};
    const Mesh skittle = mesh::skittle(0.38, 2 * level);
    for (const Vec3& at : {Vec3(0, 0, 0), Vec3(0.1645, -0.095, 0), Vec3(0.1645, 0.095, 0)})
        scene.bodies.push_back(make_body(skittle, at, scene.contact_distance, Vec3::Zero()));
    scene.bodies.push_back(
        make_body(mesh::ball(0.12, 2 * level), {-0.2, 0.01, 0}, scene.contact_distance, Vec3(4, 0, 0)));
    scene.planes.push_back({});
    scene.seconds = 0.15;
    scene.samples = 15;
    scene.length = 0.12;
    return scene;
}

/// A brick falls askew onto another that lies on the floor: contact between bodies, with friction.
PrecisionScene stack(int level) {
    PrecisionScene scene;
    scene.material = {.young_modulus = 1e5, .poisson_ratio = 0.3, .density = 1000, .friction = 0.5};
    scene.bodies.push_back(make_body(mesh::box({0.16, 0.1, 0.05}, {3 * level, 2 * level, level}), Vec3::Zero(),
                                     scene.contact_distance, Vec3::Zero()));
    scene.bodies.push_back(make_body(mesh::box({0.1, 0.08, 0.05}, {2 * level, 2 * level, level}), {0.02, 0.01, 0.06},
                                     scene.contact_distance, Vec3(0.3, 0.1, -0.5)));
    scene.planes.push_back({});
    scene.seconds = 0.2;
    scene.samples = 20;
    scene.length = 0.1;
    return scene;
}

/// A gripper's finger of soft rubber, held at its root, falls under its weight until its tip bends around the floor.
PrecisionScene finger(int level) {
    constexpr Real length = 0.1, edge = 0.02, above = 0.03;  // [m]
    PrecisionScene scene;
    scene.material = {.young_modulus = 1e5, .poisson_ratio = 0.45, .density = 1000, .friction = 0.5};
    PrecisionBody body =
        make_body(mesh::box({length, edge, edge}, {5 * level, level, level}), Vec3::Zero(), above, Vec3::Zero());
    for (std::size_t n = 0; n < body.mesh.nodes.size(); ++n)
        if (body.mesh.nodes[n].x() < -length / 2 + 1e-9) body.fixed.push_back(static_cast<Index>(n));
    scene.bodies.push_back(std::move(body));
    scene.planes.push_back({});
    scene.seconds = 0.3;
    scene.samples = 30;
    scene.length = length;
    return scene;
}

/// Eight balls fall into a box.
PrecisionScene pile(int level) {
    constexpr Real radius = 0.05, wall = 0.12;  // [m]
    PrecisionScene scene;
    scene.material = {.young_modulus = 5e4, .poisson_ratio = 0.3, .density = 1000, .friction = 0.5};
    const Mesh ball = mesh::ball(radius, 2 * level);
    for (int i = 0; i < 8; ++i) {
        const Vec3 at(i % 2 ? 0.057 : -0.055, i / 2 % 2 ? 0.056 : -0.058, 0.11 * (i / 4) + 0.004 * (i % 4));
        scene.bodies.push_back(make_body(ball, at + Vec3(0.01 * (i / 4), 0.012 * (i / 4), 0), 0.02, Vec3::Zero()));
    }
    scene.planes = {{},
                    {{1, 0, 0}, {-wall, 0, 0}},
                    {{-1, 0, 0}, {wall, 0, 0}},
                    {{0, 1, 0}, {0, -wall, 0}},
                    {{0, -1, 0}, {0, wall, 0}}};
    scene.seconds = 1.5;
    scene.samples = 30;
    scene.length = 2 * radius;
    return scene;
}

}  // namespace

void set_masses(PrecisionScene& scene) {
    for (PrecisionBody& body : scene.bodies) {
        const std::vector<Vec3>& x = body.mesh.nodes;
        body.mass.assign(x.size(), 0);
        for (const auto& t : body.mesh.tetrahedra) {
            const auto at = [&](int k) -> const Vec3& {
                return x[static_cast<std::size_t>(t[static_cast<std::size_t>(k)])];
            };
            const Real volume = (at(1) - at(0)).cross(at(2) - at(0)).dot(at(3) - at(0)) / 6;
            for (const Index n : t) body.mass[static_cast<std::size_t>(n)] += scene.material.density * volume / 4;
        }
    }
}

std::size_t PrecisionScene::nodes() const {
    std::size_t count = 0;
    for (const PrecisionBody& body : bodies) count += body.mesh.nodes.size();
    return count;
}

std::size_t PrecisionScene::tetrahedra() const {
    std::size_t count = 0;
    for (const PrecisionBody& body : bodies) count += body.mesh.tetrahedra.size();
    return count;
}

const std::vector<std::string>& trajectory_scenes() {
    static const std::vector<std::string> names{"twist", "bounce", "slide", "stack", "skittles"};
    return names;
}

const std::vector<std::string>& mesh_scenes() {
    static const std::vector<std::string> names{"twist", "bounce", "slide", "stack", "skittles", "finger"};
    return names;
}

PrecisionScene make_scene(std::string_view name, int level) {
    PrecisionScene scene;
    if (name == "bounce")
        scene = bounce(level);
    else if (name == "slide")
        scene = slide(level);
    else if (name == "twist")
        scene = twist(level);
    else if (name == "skittles")
        scene = skittles(level);
    else if (name == "stack")
        scene = stack(level);
    else if (name == "finger")
        scene = finger(level);
    else if (name == "pile")
        scene = pile(level);
    else
        throw std::invalid_argument("no scene is called " + std::string(name));
    scene.name = name;
    scene.level = level;
    scene.material.model = MaterialModel::corotational;
    lose_nothing(scene.material);
    set_masses(scene);
    return scene;
}

int usual_level(std::string_view name) {
    return name == "bounce" ? 3 : 2;
}

PrecisionScene make_creep_scene(Real fraction) {
    PrecisionScene scene;
    scene.name = "creep";
    scene.material = {.young_modulus = 1e5, .poisson_ratio = 0.3, .density = 1000, .friction = 0.5, .damping = 200};
    scene.material.model = MaterialModel::corotational;
    scene.stiffness_damping = 1e-2;
    scene.bodies.push_back(
        make_body(mesh::box({0.1, 0.1, 0.05}, {3, 3, 2}), Vec3::Zero(), scene.contact_distance, Vec3::Zero()));
    scene.planes.push_back({});
    // The weight acts first, and the pull follows slowly, with much damping. A soft block at 99 % of the cone flutters
    // into sliding if its own oscillations are not damped. With 30/s it does so at any step and any tolerance. This is
    // mechanics, not creep.
    const Real pull = fraction * scene.material.friction * g;
    scene.gravity = {{0, {0, 0, -g}}, {0.2 * creep_settling, {0, 0, -g}}, {0.6 * creep_settling, {pull, 0, -g}}};
    scene.seconds = creep_settling + creep_measured;
    scene.samples = 20;
    scene.length = 0.1;
    set_masses(scene);
    return scene;
}

void perturb(PrecisionScene& scene, std::uint32_t seed, Real amplitude) {
    std::mt19937 random(seed);
    // The numbers are scaled by hand, since the distributions of standard libraries differ.
    const auto next = [&] { return amplitude * (2 * static_cast<Real>(random()) / 4294967295.0 - 1); };
    for (PrecisionBody& body : scene.bodies) {
        const Real x = next(), y = next(), z = next();
        for (Vec3& node : body.mesh.nodes) node += Vec3(x, y, std::abs(z));  // never into the floor
    }
}

void write_scene(const PrecisionScene& scene, const std::filesystem::path& file) {
    using Json = nlohmann::json;
    const auto list = [](const Vec3& v) { return Json{v.x(), v.y(), v.z()}; };
    Json json{{"name", scene.name},
              {"seconds", scene.seconds},
              {"samples", scene.samples},
              {"contact_distance", scene.contact_distance}};
    json["material"] = {{"young_modulus", scene.material.young_modulus},
                        {"poisson_ratio", scene.material.poisson_ratio},
                        {"density", scene.material.density},
                        {"friction", scene.material.friction},
                        {"stiffness_damping", scene.stiffness_damping}};
    for (const GravityKey& key : scene.gravity)
        json["gravity"].push_back({key.time, key.gravity.x(), key.gravity.y(), key.gravity.z()});
    json["planes"] = Json::array();
    for (const PrecisionPlane& plane : scene.planes)
        json["planes"].push_back({{"normal", list(plane.normal)}, {"point", list(plane.point)}});
    for (const PrecisionBody& body : scene.bodies) {
        Json one{{"nodes", Json::array()}, {"velocity", Json::array()}, {"fixed", body.fixed}, {"mass", body.mass}};
        if (body.sphere > 0) one["sphere"] = body.sphere;
        for (const Vec3& node : body.mesh.nodes) one["nodes"].push_back(list(node));
        for (const Vec3& velocity : body.velocity) one["velocity"].push_back(list(velocity));
        one["tetrahedra"] = body.mesh.tetrahedra;
        json["bodies"].push_back(std::move(one));
    }
    std::ofstream(file) << json;
}

}  // namespace skerry::profiling
