#include "profiling/scaling/pile.h"

#include <cmath>
#include <numbers>
#include <random>
#include <string>

namespace skerry::profiling {

namespace {

double radius_of(const Mesh& ball) {
    double radius = 0;
    for (const Vec3& node : ball.nodes) radius = std::max(radius, node.norm());
    return radius;
}

/// Uniform number in [-1, 1), identical with every compiler, unlike std::uniform_real_distribution.
double uniform(std::mt19937_64& random) {
    return 2.0 * static_cast<double>(random() >> 11) * 0x1p-53 - 1.0;
}

Vec3 random_rotation(std::mt19937_64& random) {
    const double x = uniform(random), y = uniform(random), z = uniform(random);
    return std::numbers::pi * Vec3(x, y, z) / std::sqrt(3.0);
}

void add_walls(double half, World& world) {
    world.add_collider(Plane{.normal = {0, 0, 1}});
    world.add_collider(Plane{.normal = {1, 0, 0}, .point = {-half, 0, 0}});
    world.add_collider(Plane{.normal = {-1, 0, 0}, .point = {half, 0, 0}});
    world.add_collider(Plane{.normal = {0, 1, 0}, .point = {0, -half, 0}});
    world.add_collider(Plane{.normal = {0, -1, 0}, .point = {0, half, 0}});
}

}  // namespace

World make_pile(const PileShape& shape, const Mesh& ball, int threads) {
    Settings settings;
    settings.threads = threads;
    settings.gravity = shape.falls ? Vec3(0, 0, -9.81) : Vec3(Vec3::Zero());
    World world(settings);
    const MaterialHandle rubber =
        world.add_material({.young_modulus = 5e5, .poisson_ratio = 0.4, .density = 1000, .friction = 0.5});
    const double pitch = 2 * radius_of(ball) * (1 + shape.gap), half = pitch * shape.balls_per_edge / 2;
    if (shape.falls) add_walls(half, world);
    std::mt19937_64 random(1);
    const auto at = [&](int i) { return (i + 0.5) * pitch - half; };
    for (int k = 0; k < shape.balls_per_edge; ++k)
        for (int j = 0; j < shape.balls_per_edge; ++j)
            for (int i = 0; i < shape.balls_per_edge; ++i)
                world.add_body(ball, {.material = rubber,
                                      .position = Vec3(at(i), at(j), at(k) + half),
                                      .rotation = random_rotation(random)});
    return world;
}

}  // namespace skerry::profiling
