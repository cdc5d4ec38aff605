// A bar is pinned at one end and pulled at the other: first by a force, then by a clamp that moves.
#include <skerry/world.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <stdexcept>

namespace {

constexpr skerry::Real length = 0.5, width = 0.1;  // [m]
constexpr skerry::Real young_modulus = 1e5;        // [Pa]

/// Local numbers of the nodes of a body in the plane x = where.
std::vector<skerry::Index> nodes_at(const skerry::World& world, skerry::BodyHandle body, skerry::Real where) {
    std::vector<skerry::Index> found;
    const std::span<const skerry::Vec3> position = world.positions(body);
    for (std::size_t i = 0; i < position.size(); ++i)
        if (std::abs(position[i].x() - where) < 1e-9) found.push_back(static_cast<skerry::Index>(i));
    return found;
}

void advance(skerry::World& world, skerry::Real seconds) {
    const skerry::StepReport report = world.advance(seconds);
    if (!report.ok()) throw std::runtime_error(report.message());
}

}  // namespace

int main() {
    skerry::World world({.gravity = {0, 0, 0}});
    // Poisson's ratio 0 keeps the clamped end from being stiffer than the rest, so that Hooke's law for a bar is exact
    // for small strains.
    auto rubber =
        world.add_material({.young_modulus = young_modulus, .poisson_ratio = 0, .density = 1000, .damping = 60});
    auto bar = world.add_body(skerry::mesh::box({length, width, width}, {10, 2, 2}), {.material = rubber});
    const std::vector<skerry::Index> left = nodes_at(world, bar, -length / 2), right = nodes_at(world, bar, length / 2);
    world.attach(bar, left);

    // A force of 10 N along x, spread evenly over the end: each triangle gives a third of its load to each of its
    // nodes. The strain is F / (E A) = 1 %.
    const skerry::Real pull = 10;  // [N]
    std::vector<skerry::Vec3> load(world.positions(bar).size(), skerry::Vec3::Zero());
    for (const auto& triangle : world.surface(bar)) {
        const auto at = [&](std::size_t k) -> const skerry::Vec3& {
            return world.positions(bar)[static_cast<std::size_t>(triangle[k])];
        };
        if (std::min({at(0).x(), at(1).x(), at(2).x()}) < length / 2 - 1e-9) continue;
        const skerry::Real area = (at(1) - at(0)).cross(at(2) - at(0)).norm() / 2;
        for (const skerry::Index node : triangle)
            load[static_cast<std::size_t>(node)].x() += pull * area / (width * width) / 3;
    }
    world.set_loads(bar, load);
    advance(world, 1.0);
    skerry::Real end = 0;  // mean [m]
    for (const skerry::Index node : right)
        end += world.positions(bar)[static_cast<std::size_t>(node)].x() / static_cast<skerry::Real>(right.size());
    const skerry::Real strain = (end - length / 2) / length;
    std::cout << "10 N stretch the bar by " << 100 * strain << " %, Hooke's law says "
              << 100 * pull / (young_modulus * width * width) << " %.\n";

    // Let go, hold the end in a clamp instead, and move that for a tenth of a second.
    world.set_loads(bar, std::vector<skerry::Vec3>(load.size(), skerry::Vec3::Zero()));
    advance(world, 1.0);
    auto clamp = world.attach(bar, right, {.velocity = {0.1, 0, 0}});
    advance(world, 0.1);
    const skerry::Real stretched = world.positions(bar)[static_cast<std::size_t>(right.front())].x() - length / 2;
    std::cout << "The clamp moved by " << 1000 * stretched << " mm.\n";

    // Take the clamp off: the bar swings back.
    world.remove(clamp);
    advance(world, 1.0);
    const skerry::Real back = world.positions(bar)[static_cast<std::size_t>(right.front())].x() - length / 2;
    std::cout << "Without it the end came back to " << 1000 * back << " mm.\n";

    // The tolerance is 1 %, since Hooke's law holds for small strains.
    const bool as_expected =
        std::abs(strain - 0.01) < 0.01 * 0.01 && std::abs(stretched - 0.01) < 1e-4 && std::abs(back) < 1e-4;
    return as_expected ? 0 : 1;
}
