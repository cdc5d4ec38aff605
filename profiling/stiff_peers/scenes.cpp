#include "profiling/stiff_peers/scenes.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "profiling/stiff_pile.h"

namespace skerry::profiling {
namespace {

constexpr Real g = 9.81;       // [m/s^2]
constexpr Real sample = 0.01;  // interval of the samples: the longest step that is compared [s]

PrecisionBody body_of(Mesh mesh, const Vec3& position, const Vec3& rotation = Vec3::Zero()) {
    const Real angle = rotation.norm();
    const Mat3 turn = angle > 0 ? Eigen::AngleAxis<Real>(angle, rotation / angle).toRotationMatrix() : Mat3::Identity();
    for (Vec3& node : mesh.nodes) node = turn * node + position;
    PrecisionBody body{.mesh = std::move(mesh), .velocity = {}, .fixed = {}, .mass = {}};
    body.velocity.assign(body.mesh.nodes.size(), Vec3::Zero());
    return body;
}

void last_for(PrecisionScene& scene, Real seconds, Real interval = sample) {
    scene.samples = static_cast<int>(std::ceil(seconds / interval - 1e-9));
    scene.seconds = scene.samples * interval;
}

/// Mesh of a box of the given size and number of cells along its axes, with each cell cut into `finer` parts per axis.
Mesh box_of(const Vec3& size, std::array<int, 3> cells, int finer) {
    for (int& count : cells) count *= finer;
    return mesh::box(size, cells);
}

/// Adds a block that starts on the plane, at the distance that it keeps.
void add_incline(PrecisionScene& scene, Real degrees, int finer) {
    const Real angle = std::atan(incline_friction) + degrees * std::numbers::pi / 180;
    scene.material.friction = incline_friction;
    scene.gravity = {{.time = 0, .gravity = g * Vec3(std::sin(angle), 0, -std::cos(angle))}};
    scene.planes.push_back({});
    scene.bodies.push_back(body_of(box_of({0.2, 0.2, 0.1}, {4, 4, 2}, finer), {0, 0, 0.05 + scene.contact_distance}));
    last_for(scene, 1);
}

void add_cantilever(PrecisionScene& scene, int finer) {
    PrecisionBody body = body_of(box_of({1, 0.1, 0.1}, {20, 2, 2}, finer), {0, 0, 0});
    for (std::size_t n = 0; n < body.mesh.nodes.size(); ++n)
        if (body.mesh.nodes[n].x() < -0.5 + 1e-9) body.fixed.push_back(static_cast<Index>(n));
    scene.bodies.push_back(std::move(body));
    // The duration is a little more than five periods of beam theory.
    const Real slower = std::sqrt(1e7 / scene.material.young_modulus);
    last_for(scene, 3.25 * slower, sample * slower);
}

void add_stack(PrecisionScene& scene, int finer) {
    scene.planes.push_back({});
    const Mesh block = box_of({0.2, 0.2, 0.1}, {4, 4, 2}, finer);
    for (int k = 0; k < 8; ++k) scene.bodies.push_back(body_of(block, {0, 0, 0.06 + 0.11 * k}));
    last_for(scene, 1);
}

void add_ball_on_block(PrecisionScene& scene, int finer) {
    constexpr Real radius = 0.1, fall = 0.3, height = 0.3;  // [m]
    scene.planes.push_back({});
    scene.bodies.push_back(
        body_of(box_of({1, 1, height}, {10, 10, 3}, finer), {0, 0, height / 2 + scene.contact_distance}));
    scene.bodies.push_back(
        body_of(mesh::sphere_picture(radius), {0, 0, scene.contact_distance + height + fall + radius}));
    scene.bodies.back().sphere = radius;
    last_for(scene, 0.5);
}

void add_pile(PrecisionScene& scene, int finer) {
    scene.planes.push_back({});
    for (const Vec3& inward : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)})
        scene.planes.push_back({.normal = inward, .point = -0.22 * inward});
    for (const PiledCube& cube : piled_cubes())
        scene.bodies.push_back(body_of(box_of({0.1, 0.1, 0.1}, {2, 2, 2}, finer), cube.position, cube.rotation));
    last_for(scene, 1);
}

/// Sets the mass of a sphere to that of a solid one, spread evenly over the nodes of its mesh.
void set_sphere_masses(PrecisionScene& scene) {
    constexpr Real density = 8000;  // [kg/m^3]
    for (PrecisionBody& body : scene.bodies) {
        if (body.sphere == 0) continue;
        const Real mass = density * 4 * std::numbers::pi / 3 * std::pow(body.sphere, 3);
        body.mass.assign(body.mesh.nodes.size(), mass / static_cast<Real>(body.mesh.nodes.size()));
    }
}

}  // namespace

PrecisionScene make_stiff_scene(std::string_view name, Real young_modulus, int finer) {
    PrecisionScene scene;
    scene.name = name;
    // The material has no losses. Any loss of motion then comes from steps and contacts.
    scene.material = {.young_modulus = young_modulus,
                      .poisson_ratio = 0.3,
                      .density = 1000,
                      .friction = 0.5,
                      .loss_factor = 0,
                      .bulk_viscosity = 0};
    if (name == "holds")
        add_incline(scene, incline_below, finer);
    else if (name == "slides")
        add_incline(scene, incline_above, finer);
    else if (name == "cantilever")
        add_cantilever(scene, finer);
    else if (name == "stack")
        add_stack(scene, finer);
    else if (name == "ball on block")
        add_ball_on_block(scene, finer);
    else if (name == "pile")
        add_pile(scene, finer);
    else
        throw std::invalid_argument("No scene of stiff bodies: " + std::string(name));
    set_masses(scene);
    set_sphere_masses(scene);
    return scene;
}

PrecisionScene without_distance(PrecisionScene scene) {
    constexpr Real sunk = 1e-5;  // depth: 1 kPa over the 1e8 Pa/m of Drake's contacts [m]
    for (PrecisionPlane& plane : scene.planes) plane.point += (scene.contact_distance + sunk) * plane.normal;
    scene.contact_distance = 0;
    return scene;
}

}  // namespace skerry::profiling
