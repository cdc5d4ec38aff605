// Small regions in lanes: equal to a region solved alone, equal to the ordinary path, and independent of each other.
#include <catch2/catch.hpp>

#include "systems/solver/lanes/solve_lane_batch.h"
#include "systems/solver/lanes/solve_lanes.h"
#include "tests/support/contact_scene.h"

namespace skerry::test::lanes_test {

namespace {

/// Region `number` of many different small ones, with `contacts` contacts on up to four nodes each. The contacts form
/// chains that share nodes at random.
struct SmallRegion {
    std::vector<LumpedContact> contact;
    std::vector<Vec4> free_velocity, impulse;
    std::size_t node_count = 0;
    Real scale = 0;

    SmallRegion(std::size_t contacts, unsigned seed) {
        std::mt19937 random(seed);
        std::normal_distribution<Real> noise;
        node_count = contacts + 3;
        std::vector<Real> inverse_mass(node_count);
        for (Real& m : inverse_mass) m = std::exp(0.5 * noise(random));
        const auto near_vertical = [&] {
            return padded(Vec3(0.2 * noise(random), 0.2 * noise(random), 1).normalized());
        };
        for (std::size_t i = 0; i < contacts; ++i) {
            LumpedContact c;
            c.normal = near_vertical();
            c.offset = Vec4::Zero();
            c.bias = 0;
            c.node_count = static_cast<Index>(1 + random() % 4);
            c.diagonal = 0;
            for (Index a = 0; a < c.node_count; ++a) {
                const auto slot = static_cast<std::size_t>(a);
                c.node[slot] = static_cast<Index>(i + slot);
                c.weight[slot] = a == 0 ? 1 : -1.0 / (c.node_count - 1);
                c.step[slot] = c.weight[slot] * inverse_mass[i + slot];
                c.diagonal += c.weight[slot] * c.step[slot];
            }
            c.inverse_diagonal = 1 / c.diagonal;
            const Real mu = seed % 3 == 0 ? 0 : 0.5;
            c.friction = {mu, mu};
            contact.push_back(c);
            free_velocity.emplace_back(noise(random), noise(random), noise(random) - 0.5, 0);
            impulse.push_back(seed % 2 == 0 ? Vec4(0.1 * c.normal) : Vec4(Vec4::Zero()));
            scale += c.inverse_diagonal * free_velocity.back().squaredNorm();
        }
        scale = std::sqrt(scale);
    }
    LaneRegion lane(std::vector<Vec4>& out, Real tolerance) const {
        return {contact, free_velocity, out, node_count, scale, tolerance};
    }
};

template <int K>
void check_against_twin() {
    std::vector<SmallRegion> regions;
    for (unsigned seed = 0; seed < element_lanes; ++seed) regions.emplace_back(1 + (seed * 5 + K) % K, 100 * K + seed);
    LaneProblem<Real8, K> together;
    clear(together);
    LaneMask<Real8> filled{};
    const auto tolerance_of = [](int lane) { return lane % 3 == 0 ? 1e-4 : 1e-8; };
    for (int l = 0; l < element_lanes; ++l) {
        auto& region = regions[static_cast<std::size_t>(l)];
        fill_lane(region.lane(region.impulse, tolerance_of(l)), l, together);
        filled[l] = -1;
    }
    const auto all = solve_lanes<Real8, K>(together, filled, lane_sweep_limit, 1);
    for (int l = 0; l < element_lanes; ++l) {
        CAPTURE(K, l);
        auto& region = regions[static_cast<std::size_t>(l)];
        LaneProblem<Real, K> alone;
        clear(alone);
        fill_lane(region.lane(region.impulse, tolerance_of(l)), 0, alone);
        const auto one = solve_lanes<Real, K>(alone, true, lane_sweep_limit, 1);
        REQUIRE((all.solved[l] != 0) == one.solved);
        CHECK(all.iterations[l] == one.iterations);
        CHECK(all.error[l] == one.error);
        for (int i = 0; i < K; ++i) CHECK(lane_of(together.impulse[i], l) == lane_of(alone.impulse[i], 0));
    }
}

/// Many small regions of point masses and triangles, with a few single contacts.
ContactScene many_small_regions(int count, Real mu) {
    ContactScene scene;
    for (int k = 0; k < count; ++k) {
        const Index first = scene.add_node(1 + 0.01 * k, Vec3(0.3, 0.1 * (k % 5), -1 - 0.01 * k));
        scene.touch_floor(first, mu);
        Index below = first;
        for (int level = 1; level <= k % 13; ++level) {
            const Index node = scene.add_node(0.7, Vec3(-0.2, 0.05 * level, -1.2));
            scene.touch_node(node, below, Vec3(0.1 * (level % 3), 0.05, 1), mu);
            below = node;
        }
    }
    return scene;
}

}  // namespace

TEST_CASE("every lane has the bits of its region on its own", "[determinism][solver]") {
    check_against_twin<2>();
    check_against_twin<3>();
    check_against_twin<4>();
    check_against_twin<6>();
    check_against_twin<8>();
    check_against_twin<12>();
}

TEST_CASE("a region comes out the same whatever shares its batch and however far it is padded",
          "[determinism][solver]") {
    for (std::size_t contacts = 2; contacts <= 12; ++contacts) {
        const SmallRegion region(contacts, 7);
        std::vector<Vec4> alone = region.impulse, widest = region.impulse;
        std::array<LaneResult, element_lanes> result, other;
        const LaneRegion single = region.lane(alone, 1e-6);
        solve_lane_batch(lane_size_class(contacts), {&single, 1}, 200, 1, result);
        REQUIRE(result[0].solved);
        std::vector<SmallRegion> strangers;
        std::vector<std::vector<Vec4>> out;
        for (unsigned seed = 0; seed < 7; ++seed) {
            strangers.emplace_back(12, seed);
            out.push_back(strangers.back().impulse);
        }
        strangers[3].free_velocity[2].setConstant(std::numeric_limits<Real>::quiet_NaN());
        std::vector<LaneRegion> batch;
        for (std::size_t k = 0; k < 7; ++k) batch.push_back(strangers[k].lane(out[k], 1e-3));
        batch.insert(batch.begin() + 5, region.lane(widest, 1e-6));
        solve_lane_batch(lane_sizes.size() - 1, batch, 200, 1, other);
        CHECK(other[5].iterations == result[0].iterations);
        CHECK(other[5].error == result[0].error);
        CHECK(alone == widest);
        CHECK_FALSE(other[3].solved);
        CHECK(out[3] == strangers[3].impulse);
    }
}

TEST_CASE("lanes and the ordinary path take the same sweeps to the same impulses", "[unit][solver]") {
    for (const Real mu : {0.0, 0.4}) {
        const ContactScene scene = many_small_regions(200, mu);
        for (const Real tolerance : {1e-3, 1e-7}) {
            SolverSettings with, without;
            with.tolerance = without.tolerance = tolerance;
            without.small_regions_in_lanes = false;
            const SolvedScene lanes = scene.solve(with), ordinary = scene.solve(without);
            Index in_lanes = 0;
            for (std::size_t r = 0; r < lanes.regions.size(); ++r) {
                in_lanes += (lanes.regions.shortcut[r] & shortcut_in_lanes) != 0;
                CHECK((ordinary.regions.shortcut[r] & shortcut_in_lanes) == 0);
                CHECK(lanes.regions.iterations[r] == ordinary.regions.iterations[r]);
                CHECK(lanes.regions.status[r] == ordinary.regions.status[r]);
            }
            CHECK(in_lanes > 100);
            for (std::size_t i = 0; i < scene.stencil.size(); ++i)
                CHECK((lanes.impulse[i] - ordinary.impulse[i]).norm() < 1e-10);
            for (std::size_t n = 0; n < scene.velocity.size(); ++n)
                CHECK((lanes.velocity[n] - ordinary.velocity[n]).norm() < 1e-10);
        }
    }
}

TEST_CASE("a region that lanes do not finish is solved as if it had never been there", "[unit][solver]") {
    const ContactScene scene = many_small_regions(13, 0.4);
    SolverSettings with, without;
    with.tolerance = without.tolerance = 1e-13;  // needs more sweeps than lanes do
    with.max_iterations = without.max_iterations = 2000;
    without.small_regions_in_lanes = false;
    const SolvedScene lanes = scene.solve(with), ordinary = scene.solve(without);
    std::size_t left_over = 0;
    for (std::size_t r = 0; r < lanes.regions.size(); ++r) {
        if (lanes.regions.shortcut[r] != shortcut_none || lanes.regions.iterations[r] <= lane_sweep_limit) continue;
        ++left_over;
        CHECK(lanes.regions.error[r] == ordinary.regions.error[r]);
        for (const Index i : lanes.regions.contacts[r]) CHECK(lanes.impulse[i] == ordinary.impulse[i]);
    }
    CHECK(left_over > 0);
}

TEST_CASE("unlike coefficients and the pyramid keep out of the lanes", "[unit][solver]") {
    ContactScene scene = many_small_regions(13, 0.4);
    SolverSettings settings;
    settings.friction = Friction::pyramid;
    const auto in_lanes = [](const SolvedScene& solved) {
        return std::count_if(solved.regions.shortcut.begin(), solved.regions.shortcut.end(),
                             [](RegionShortcut s) { return (s & shortcut_in_lanes) != 0; });
    };
    CHECK(in_lanes(scene.solve()) == 11);  // regions of 2 to 12 contacts
    CHECK(in_lanes(scene.solve(settings)) == 0);
    for (Real& mu : scene.dynamic_friction) mu = 0.3;
    CHECK(in_lanes(scene.solve()) == 0);
}

}  // namespace skerry::test::lanes_test
