// Bending (docs/accuracy.md, items 14 and 15). Linear tetrahedra are too stiff in bending, with an error of second
// order in their size. Three meshes and Richardson's extrapolation give the limit.
#include <catch2/catch.hpp>

#include "tests/support/accuracy.h"
#include "tests/support/frequency.h"
#include "tests/support/worlds.h"

namespace skerry::test::cantilever_test {

using accuracy::Tolerance;

namespace {

constexpr Real length = 1, height = 0.1, density = 1000, modulus = 1e6, g = standard_gravity;
const Real c = std::sqrt(modulus / density);  // m/s

/// A cantilever along x, held at x = -L / 2, with m elements in its height and cubic cells. It is one element wide,
/// since the width does not matter without lateral strain.
struct Cantilever {
    World world;
    Mesh mesh;
    BodyHandle beam;
    std::vector<Real> mass;
    Real width;  // m

    Cantilever(int m, ElementKind element, Real gravity, Real damping)
        : world(settings(gravity)),
          mesh(mesh::box({length, height / m, height}, {static_cast<int>(length / height) * m, 1, m})),
          width(height / m) {
        const auto material = world.add_material({.young_modulus = modulus,
                                                  .poisson_ratio = 0,
                                                  .density = density,
                                                  .damping = damping,
                                                  .model = MaterialModel::linear});
        beam = world.add_body(mesh, {.material = material, .element = element});
        world.attach(beam, nodes_at(-length / 2));
        mass = node_masses(world, beam, mesh, density);
    }
    static Settings settings(Real gravity) {
        Settings s;
        s.gravity = {0, 0, -gravity};
        return s;
    }
    std::vector<Index> nodes_at(Real x) const {
        std::vector<Index> rows;
        for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
            if (std::abs(mesh.nodes[n].x() - x) < 1e-9) rows.push_back(static_cast<Index>(n));
        return rows;
    }
    /// Mean downward displacement of the free end [m]
    Real deflection() const {
        const std::vector<Index> tip = nodes_at(length / 2);
        Real sum = 0;
        for (Index n : tip)
            sum += mesh.nodes[static_cast<std::size_t>(n)].z() - world.positions(beam)[static_cast<std::size_t>(n)].z();
        return sum / static_cast<Real>(tip.size());
    }
};

// First frequency of an Euler-Bernoulli beam [rad/s]
const Real first_frequency = 1.8751 * 1.8751 * c * height / (std::sqrt(12.0) * length * length);

constexpr Real inertia = height * height * height / 12, shear = modulus / 2;  // per metre of width [m^3]; [Pa]
constexpr Real tip_deflection =
    length * length * length / (3 * modulus * inertia) + length / (5.0 / 6 * shear * height);  // m
constexpr Real weight_deflection = density * g * height * length * length * length * length / (8 * modulus * inertia) +
                                   density * g * length * length / (2 * 5.0 / 6 * shear);  // m

Real own_weight(int m, ElementKind element) {
    Cantilever beam(m, element, 1e-3 * g, 2 * first_frequency);
    REQUIRE(beam.world.advance(12 / first_frequency).ok());
    return beam.deflection() / 1e-3;
}

Real tip_load(int m, ElementKind element) {
    Cantilever beam(m, element, 0, 2 * first_frequency);
    const std::vector<Index> tip = beam.nodes_at(length / 2);
    std::vector<Vec3> load(beam.mass.size(), Vec3::Zero());
    // The total load is 1e-3 N per metre of width.
    for (Index n : tip) load[static_cast<std::size_t>(n)].z() = -1e-3 * beam.width / static_cast<Real>(tip.size());
    beam.world.set_loads(beam.beam, load);
    REQUIRE(beam.world.advance(12 / first_frequency).ok());
    return beam.deflection() / 1e-3;
}

/// First frequency [rad/s]
Real frequency(int m, ElementKind element) {
    Cantilever beam(m, element, 0, 0);
    std::vector<Real> part;
    std::vector<Vec3> velocity;
    const Real k = 1.8751 / length, mix = 0.7341;
    for (const Vec3& node : beam.mesh.nodes) {
        const Real s = k * (node.x() + length / 2);
        part.push_back(std::cosh(s) - std::cos(s) - mix * (std::sinh(s) - std::sin(s)));
        // Plane sections turn with the slope.
        const Real slope = k * (std::sinh(s) + std::sin(s) - mix * (std::cosh(s) - std::cos(s)));
        velocity.push_back(1e-3 * Vec3(-node.z() * slope, 0, part.back()));
    }
    beam.world.set_velocities(beam.beam, velocity);
    const Real h = 0.9 * beam.world.stable_step();
    std::vector<Real> sample;
    while (beam.world.time() < std::numbers::pi / first_frequency) {
        REQUIRE(beam.world.advance(h).steps == 1);
        Real sum = 0;
        for (std::size_t n = 0; n < part.size(); ++n)
            sum += beam.mass[n] * part[n] * (beam.world.positions(beam.beam)[n].z() - beam.mesh.nodes[n].z());
        sample.push_back(sum);
    }
    return angular_frequency(sample, h);
}

/// Limit of a series whose error falls with h^2, from the two finer of h, h/2 and h/4, and the order that all three
/// show. Stiffnesses follow such a series even on coarse meshes: K (1 + C h^2). Deflections are their inverse.
struct Limit {
    Real value, order;
};
Limit richardson(const std::array<Real, 3>& f) {
    return {f[2] + (f[2] - f[1]) / 3, std::log2((f[1] - f[0]) / (f[2] - f[1]))};
}

}  // namespace

TEST_CASE("a cantilever bends under a load at its tip and under its weight", "[scene][accuracy]") {
    const Limit tip = richardson({1 / tip_load(2, ElementKind::linear), 1 / tip_load(4, ElementKind::linear),
                                  1 / tip_load(8, ElementKind::linear)});
    accuracy::check(
        {.item = 15,
         .name = "cantilever, tip load of 1 N a metre of width, deflection (m)",
         .formula = "P L^3 / (3 E I) + P L / ((5/6) G A)",
         .expected = tip_deflection,
         .found = 1 / tip.value,
         .tolerance = 0.02,
         .note = "Linear tetrahedra are too stiff in bending; the value is the limit of 4 and 8 elements in the height "
                 "(Richardson, on the stiffness)."});
    const Limit weight = richardson({1 / own_weight(2, ElementKind::linear), 1 / own_weight(4, ElementKind::linear),
                                     1 / own_weight(8, ElementKind::linear)});
    accuracy::check({.item = 15,
                     .name = "cantilever, own weight, deflection of a linear material (m)",
                     .formula = "rho g A L^4 / (8 E I) + rho g L^2 / (2 (5/6) G)",
                     .expected = weight_deflection,
                     .found = 1 / weight.value,
                     .tolerance = 0.02,
                     .note = "Own weight: with the shear term that the tip load has, too; it is 0.8 % of the whole."});
    accuracy::check({.item = 31,
                     .name = "cantilever, order of the stiffness in h",
                     .formula = "2",
                     .expected = 2,
                     .found = weight.order,
                     .tolerance = 0.2,
                     .kind = Tolerance::absolute});
}

TEST_CASE("a cantilever swings with its first frequency", "[scene][accuracy]") {
    std::array<Real, 3> squared;
    for (int k = 0; k < 3; ++k)
        squared[static_cast<std::size_t>(k)] = std::pow(frequency(2 << k, ElementKind::linear), 2);
    const Limit limit = richardson(squared);
    accuracy::check({.item = 14,
                     .name = "cantilever, first frequency (Hz)",
                     .formula = "1.8751^2 / (2 pi) sqrt(E I / (rho A L^4))",
                     .expected = first_frequency / (2 * std::numbers::pi),
                     .found = std::sqrt(limit.value) / (2 * std::numbers::pi),
                     .tolerance = 0.02,
                     .note = "Limit of 4 and 8 elements in the height (Richardson, on the square). Shear and rotation, "
                             "which the formula "
                             "leaves out, lower the frequency of this "
                             "beam (L / H = 10) by 0.5 %."});
}

TEST_CASE("four smoothed elements in the height bend as the beam does", "[scene][accuracy]") {
    struct Case {
        ElementKind element;
        Real of_deflection, of_frequency;  // tolerances of both
    };
    for (const auto& [element, of_deflection, of_frequency] :
         {Case{ElementKind::linear, 0.2, 0.15}, Case{ElementKind::smoothed, 0.01, 0.02}}) {
        const std::string beam = "cantilever, 4 elements in the height, " + std::string(name_of(element));
        accuracy::check({.item = 15,
                         .name = beam + ", tip load of 1 N a metre of width, deflection (m)",
                         .formula = "P L^3 / (3 E I) + P L / ((5/6) G A)",
                         .expected = tip_deflection,
                         .found = tip_load(4, element),
                         .tolerance = of_deflection});
        accuracy::check({.item = 15,
                         .name = beam + ", own weight, deflection of a linear material (m)",
                         .formula = "rho g A L^4 / (8 E I) + rho g L^2 / (2 (5/6) G)",
                         .expected = weight_deflection,
                         .found = own_weight(4, element),
                         .tolerance = of_deflection});
        accuracy::check({.item = 14,
                         .name = beam + ", first frequency (Hz)",
                         .formula = "1.8751^2 / (2 pi) sqrt(E I / (rho A L^4))",
                         .expected = first_frequency / (2 * std::numbers::pi),
                         .found = frequency(4, element) / (2 * std::numbers::pi),
                         .tolerance = of_frequency});
    }
}

}  // namespace skerry::test::cantilever_test
