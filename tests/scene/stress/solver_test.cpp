// Stress suite: contact problems without a world (items 10, 12, 13, 16, 17, 22 and 23 of docs/stress.md).
#include <catch2/catch.hpp>
#include <numbers>

#include "tests/support/contact_scene.h"
#include "tests/support/stress.h"

namespace skerry::test::stress_solver_test {

using namespace skerry::test::stress;

namespace {

SolverSettings tight(Real tolerance = 1e-10) {
    SolverSettings settings;
    settings.tolerance = tolerance;
    settings.max_iterations = 100000;
    return settings;
}

Real largest_difference(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    Real largest = 0;
    for (std::size_t n = 0; n < a.size(); ++n) largest = std::max(largest, (a[n] - b[n]).norm());
    return largest;
}

bool finite(const SolvedScene& solved) {
    const auto all = [](const std::vector<Vec3>& rows) {
        return std::all_of(rows.begin(), rows.end(), [](const Vec3& x) { return x.allFinite(); });
    };
    return all(solved.velocity) && all(solved.impulse) && all(solved.push_out);
}

Index unconverged(const SolvedScene& solved) {
    Index count = 0;
    for (const RegionStatus status : solved.regions.status)
        count += status == RegionStatus::iteration_limit || status == RegionStatus::not_finite;
    return count;
}

/// The error of the worst region.
Real worst_error(const SolvedScene& solved) {
    Real worst = 0;
    for (const Real error : solved.regions.error) worst = std::max(worst, error);
    return worst;
}

void add_copies(ContactScene& scene, std::size_t count, int copies) {
    for (int k = 1; k < copies; ++k)
        for (std::size_t i = 0; i < count; ++i)
            scene.touch(scene.stencil[i], scene.normal[i], scene.static_friction[i]);
}

}  // namespace

TEST_CASE("a hundred copies of every contact of two sheets act like one copy", "[scene][solver][stress]") {
    ContactScene once, often;
    add_sheets(once, 6, 0.5, 2);
    add_sheets(often, 6, 0.5, 2);
    const std::size_t count = once.stencil.size();
    add_copies(often, count, 100);
    const SolvedScene single = once.solve(tight()), copied = often.solve(tight());
    const std::string scene = "32 contacts, each a hundred times";
    at_most(10, scene, "regions not converged", unconverged(single) + unconverged(copied), 0);
    // 1e-10 of an impact of 1 m/s; the copies make the condition number of the sum a hundred times worse.
    at_most(10, scene, "velocities apart from those of one copy, m/s",
            largest_difference(single.velocity, copied.velocity), 1e-7);
    std::vector<Vec3> sum(count, Vec3::Zero());
    for (std::size_t i = 0; i < copied.impulse.size(); ++i) sum[i % count] += copied.impulse[i];
    at_most(10, scene, "summed impulses apart from those of one copy, N s", largest_difference(single.impulse, sum),
            1e-6);
}

TEST_CASE("without friction three rows per contact give the result of one row", "[scene][solver][stress]") {
    ContactScene scene;
    for (int k = 0; k < 10; ++k) add_sheets(scene, 4 + k % 6, 0, static_cast<unsigned>(k));
    SolverSettings rows = tight(), vectors = tight();
    vectors.frictionless_rows = false;
    const SolvedScene one = scene.solve(rows), three = scene.solve(vectors);
    at_most(12, "ten pairs of sheets, mu 0", "velocities of one row and of three apart, m/s",
            largest_difference(one.velocity, three.velocity), 1e-7);
    at_most(12, "ten pairs of sheets, mu 0", "regions not converged", unconverged(one) + unconverged(three), 0);
}

TEST_CASE("with a friction of a thousand nothing that presses slides", "[scene][solver][stress]") {
    ContactScene scene;
    std::mt19937 random(3);
    std::normal_distribution<Real> noise;
    for (int k = 0; k < 1000; ++k)
        scene.touch_floor(scene.add_node(std::exp(noise(random)),
                                         Vec3(10 * noise(random), 10 * noise(random), -std::abs(noise(random)) - 0.1)),
                          1e3);
    const SolvedScene solved = scene.solve(tight());
    Real slip = 0;
    for (const Vec3& v : solved.velocity) slip = std::max(slip, v.norm());
    at_most(13, "1000 point masses thrown on a floor, mu 1e3", "speed left, m/s", slip, 1e-12);

    ContactScene sheets;
    add_sheets(sheets, 12, 1e3, 6);
    const SolvedScene stuck = sheets.solve(tight(1e-8));
    Real moved = 0;
    std::size_t pressing = 0;
    for (std::size_t i = 0; i < sheets.stencil.size(); ++i) {
        if (!(stuck.impulse[i].dot(sheets.normal[i]) > 1e-6)) continue;
        ++pressing;
        moved = std::max(moved, sheets.relative_velocity(i, stuck.velocity).norm());
    }
    at_least(13, "two sheets of 200 contacts, mu 1e3", "contacts that press", static_cast<Real>(pressing), 20);
    at_most(13, "two sheets of 200 contacts, mu 1e3", "regions not converged", unconverged(stuck), 0);
    at_most(13, "two sheets of 200 contacts, mu 1e3", "slip of contacts that press, m/s", moved, 1e-5);
}

TEST_CASE("a region of a hundred thousand contacts is solved", "[scene][solver][stress][slow]") {
    ContactScene scene;
    add_sheets(scene, 226, 0.5, 1);
    SolverSettings settings;
    const SolvedScene solved = scene.solve(settings, ContactRegions::separate, Backend::automatic, 2);
    const std::string name = "two sheets of " + std::to_string(scene.stencil.size()) + " contacts, " +
                             std::to_string(solved.regions.iterations[0]) + " sweeps";
    at_most(16, name, "regions", static_cast<Real>(solved.regions.size()), 1);
    at_most(16, name, "error", worst_error(solved), settings.tolerance);
    judge({16, name, "finite", finite(solved) ? "yes" : "no", finite(solved)});
}

TEST_CASE("a hundred thousand regions of one contact are solved in closed form", "[scene][solver][stress]") {
    ContactScene scene;
    std::mt19937 random(8);
    std::normal_distribution<Real> noise;
    for (int k = 0; k < 100000; ++k)
        scene.touch_floor(
            scene.add_node(std::exp(noise(random)), Vec3(noise(random), noise(random), -std::abs(noise(random)))), 0.5);
    const SolvedScene solved = scene.solve({}, ContactRegions::separate, Backend::automatic, 2);
    const auto closed = std::count_if(solved.regions.shortcut.begin(), solved.regions.shortcut.end(),
                                      [](RegionShortcut s) { return (s & shortcut_closed_form) != 0; });
    at_least(17, "100000 masses on a floor", "regions solved in closed form", static_cast<Real>(closed), 1e5);
    Real wrong = 0;
    for (std::size_t i = 0; i < scene.stencil.size(); ++i) {
        // docs/methods/friction.md 2.1: friction removes up to mu times the normal speed.
        const Vec3& v = scene.velocity[i];
        const Real slide = std::max(0.0, 1 - 0.5 * -v.z() / v.head<2>().norm());
        wrong = std::max(wrong, (solved.velocity[i] - Vec3(slide * v.x(), slide * v.y(), 0)).norm());
    }
    at_most(17, "100000 masses on a floor", "velocity apart from the closed form, m/s", wrong, 1e-13);
}

TEST_CASE("a jam of normals at random with a friction of three is solved or flagged, and never made worse",
          "[scene][solver][stress]") {
    int flagged = 0, problems = 0, silent = 0, worse = 0;
    bool all_finite = true;
    for (unsigned seed = 0; seed < 40; ++seed) {
        ContactScene scene;
        std::mt19937 random(seed);
        std::normal_distribution<Real> noise;
        add_sheets(scene, 8, 3, seed);
        for (Vec3& n : scene.normal) {
            const Real tilt = (35 + 35 * (seed % 2)) * std::numbers::pi / 180;
            n = (n + std::tan(tilt) * Vec3(noise(random), noise(random), noise(random)).normalized()).normalized();
        }
        SolverSettings settings;
        settings.tolerance = 1e-6;
        settings.max_iterations = 2000;
        const SolvedScene solved = scene.solve(settings);
        ++problems;
        all_finite &= finite(solved);
        for (std::size_t r = 0; r < solved.regions.size(); ++r) {
            const bool converged = solved.regions.error[r] <= settings.tolerance;
            const bool flag = solved.regions.status[r] == RegionStatus::iteration_limit;
            flagged += flag;
            silent += !converged && !flag;
            worse += solved.regions.error[r] > 1.2;  // zero impulses have an error of about 1
        }
        worse += scene.kinetic_energy(solved.velocity) > scene.kinetic_energy(scene.velocity);
    }
    const std::string scene = std::to_string(problems) +
                              " jams of 72 contacts, mu 3, normals tilted by 35 or 70 degrees, " +
                              std::to_string(flagged) + " flagged";
    judge({22, scene, "finite", all_finite ? "yes" : "no", all_finite});
    at_most(22, scene, "regions above the tolerance without a flag", silent, 0);
    at_most(22, scene, "worse than no impulse, or energy gained", worse, 0);
    at_most(22, scene, "flagged", flagged, problems / 2);
}

TEST_CASE("ten thousand points on one triangle are solved", "[scene][solver][stress]") {
    ContactScene scene;
    std::mt19937 random(4);
    std::uniform_real_distribution<Real> unit(0, 1);
    std::array<Index, 3> hub;
    for (Index& n : hub) n = scene.add_node(100, Vec3::Zero());
    for (int k = 0; k < 10000; ++k) {
        const Index point =
            scene.add_node(0.01 + 0.01 * unit(random), Vec3(0.2 * unit(random), 0.1, -1 - 0.2 * unit(random)));
        Real a = unit(random), b = unit(random);
        if (a + b > 1) {
            a = 1 - a;
            b = 1 - b;
        }
        scene.touch({{point, hub[0], hub[1], hub[2]}, {1, a + b - 1, -a, -b}}, Vec3::UnitZ(), 0.5);
    }
    SolverSettings settings;
    settings.max_iterations = 2000;
    const SolvedScene solved = scene.solve(settings, ContactRegions::separate, Backend::automatic, 2);
    const std::string name = "10000 points of 150 kg together on a triangle of 300 kg, " +
                             std::to_string(solved.regions.iterations[0]) + " sweeps";
    judge(
        {23, name, "one region, finite", finite(solved) ? "yes" : "no", finite(solved) && solved.regions.size() == 1});
    at_most(23, name, "error", worst_error(solved), settings.tolerance);
    at_most(23, name, "energy left / before",
            scene.kinetic_energy(solved.velocity) / scene.kinetic_energy(scene.velocity), 1);
}

}  // namespace skerry::test::stress_solver_test
