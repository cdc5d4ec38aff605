#include "systems/collision/find_crossings.h"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>

#include "systems/collision/inputs/contact_key.h"
#include "tests/support/collision_world.h"

namespace skerry::test::find_crossings_test {

using test::CollisionWorld;

namespace {

constexpr Real h = 1e-3;
constexpr Real shell = 0.02;  // contact distance [m]

/// A plate of one layer with its top at z = 0, and a spike that points down at it from `height`.
struct SpikeOverPlate {
    CollisionWorld w;
    Index plate, spike;
    Vec3 tip;

    explicit SpikeOverPlate(Real height) : tip(0.13, 0.62, height) {
        plate = w.add_solid(test::box_mesh({4, 4, 1}, {4, 4, 0.1}), w.at({0, 0, -0.05}), shell);
        const test::SolidMesh mesh{
            {tip, tip + Vec3(0.1, 0, 0.5), tip + Vec3(-0.1, 0.1, 0.5), tip + Vec3(-0.1, -0.1, 0.5)}, {{0, 1, 2, 3}}};
        spike = w.add_solid(mesh, w.at(Vec3::Zero()), shell);
    }
    void move_spike(const Vec3& velocity) {
        for (Index n = w.body.nodes[spike].begin; n < w.body.nodes[spike].end; ++n) w.nodes.velocity[n] = velocity;
        w.measure_speed();
    }
    Index crossings() {
        const std::vector<Vec3> none(w.nodes.position.size(), Vec3::Zero());
        const Index count =
            find_crossings(*w.executor, w.inputs(), w.settings, h, w.nodes.velocity, none, w.pairs, w.crossings);
        use_crossings(w.pairs, w.crossings);
        return count;
    }
    /// The contact of the tip that is nearest to `place`.
    const ContactRow* row_of_tip(const Vec3& place) const {
        const ContactRow* best = nullptr;
        for (const ContactRow& row : w.crossings.row) {
            if (row.kind != ContactKind::point_triangle || row.stencil.node[0] != w.body.nodes[spike].begin) continue;
            if (!best || (row.point - place).norm() < (best->point - place).norm()) best = &row;
        }
        return best;
    }
};

}  // namespace

TEST_CASE("a point that would go through a face becomes a contact where it meets the face", "[unit]") {
    SpikeOverPlate s(0.03);
    s.move_spike({200, 0, -50});  // 0.2 along and 0.05 down within the step
    s.w.find(h);
    REQUIRE(s.crossings() > 0);
    // The path of the tip crosses the plane 0.12 further on. There it is noticed a tenth of its height above the plane,
    // at a slope of 1 to 4.
    const Vec3 through(0.13 + 0.12, 0.62, 0);
    const ContactRow* row = s.row_of_tip(through);
    REQUIRE(row);
    CHECK(row->normal[2] == Approx(1));
    CHECK(row->gap == Approx(0.03 - shell));
    CHECK((row->point - through).norm() <= 0.1 * 0.03 * 4 + 1e-9);

    // The next attempt has it among its contacts, in key order, each key once.
    s.w.find(h);
    const auto at = std::find(s.w.contacts.key.begin(), s.w.contacts.key.end(), row->key);
    REQUIRE(at != s.w.contacts.key.end());
    const std::size_t c = static_cast<std::size_t>(at - s.w.contacts.key.begin());
    CHECK(s.w.contacts.stencil[c].node == row->stencil.node);
    CHECK(s.w.contacts.stencil[c].weight == row->stencil.weight);
    for (std::size_t i = 1; i < s.w.contacts.size(); ++i) CHECK(s.w.contacts.key[i - 1] < s.w.contacts.key[i]);
}

TEST_CASE("motions that cannot cross are not tested, and sliding features do not cross", "[unit]") {
    SpikeOverPlate slow(0.03);
    slow.move_spike({0, 0, -10});  // a third of the distance
    slow.w.find(h);
    CHECK(slow.crossings() == 0);
    CHECK(slow.w.crossings.tested == 0);

    SpikeOverPlate along(0.03);
    along.move_spike({100, 0, 0});
    along.w.find(h);
    CHECK(along.crossings() == 0);
    CHECK(along.w.crossings.tested > 0);

    SpikeOverPlate off(0.03);
    off.w.settings.continuous = false;
    off.move_spike({0, 0, -100});
    off.w.find(h);
    CHECK(off.crossings() == 0);
    CHECK(off.w.crossings.tested == 0);
}

TEST_CASE("bodies that overlap may leave each other through their surfaces", "[unit]") {
    SpikeOverPlate s(-0.03);
    s.move_spike({0, 0, 100});
    s.w.find(h);
    REQUIRE(s.w.contacts.size() > 0);
    CHECK(s.crossings() == 0);
    CHECK(std::any_of(s.w.pairs.state.begin(), s.w.pairs.state.end(),
                      [](PairState state) { return state == PairState::overlapping; }));
}

TEST_CASE("on the last try a crossing is let through, counted, and its pair overlaps from then on", "[unit]") {
    SpikeOverPlate s(0.03);
    s.move_spike({0, 0, -100});
    s.w.find(h);
    REQUIRE(s.crossings() > 0);
    s.w.crossings.last_attempt = true;
    CHECK(s.crossings() == 0);
    CHECK(s.w.crossings.let_through > 0);
    REQUIRE(s.w.pairs.size() == 1);
    CHECK(s.w.pairs.state[0] == PairState::overlapping);
}

TEST_CASE("a pair that moves beyond the validity of its list of candidates prevents the step", "[unit]") {
    SpikeOverPlate s(0.03);
    s.w.find(h);
    s.move_spike({0, 0, 2000});  // away, into space that has not been searched
    CHECK(s.crossings() > 0);
    CHECK(s.w.crossings.beyond_lists);
}

TEST_CASE("lists that were too short are made for the motion of the step, whatever speeds were known before",
          "[unit]") {
    SpikeOverPlate s(0.03);
    s.w.find(h);
    s.w.search.end_step(true);  // from now on speeds count as known
    s.move_spike({0, 0, 2000});
    REQUIRE(s.crossings() > 0);
    std::ranges::fill(s.w.body.max_speed, 0);
    std::ranges::fill(s.w.body.frame_speed, 0);
    s.w.find(h);
    s.w.measure_speed();
    CHECK(s.crossings() == 0);
    CHECK_FALSE(s.w.crossings.beyond_lists);
    // This works once: the next step begins with the list that it finds.
    s.w.pairs.valid_until[0] = -1;
    std::ranges::fill(s.w.body.max_speed, 0);
    std::ranges::fill(s.w.body.frame_speed, 0);
    s.w.find(h);
    s.w.measure_speed();
    CHECK(s.crossings() > 0);
}

TEST_CASE("earlier drift of the nodes of a body does not shorten the validity of a list searched for this step",
          "[unit]") {
    SpikeOverPlate s(0.03);
    s.w.body.displacement[s.plate] = 10;  // after a flight at constant velocity while its nodes swung [m]
    s.w.find(h);
    s.move_spike({0, 0, -10});
    CHECK(s.crossings() == 0);
    s.move_spike({0, 0, 2000});
    CHECK(s.crossings() > 0);
}

TEST_CASE("a plate turned inside out still holds a point on the side where it is", "[unit]") {
    for (const bool continuous : {true, false}) {
        SpikeOverPlate s(shell);
        s.w.settings.continuous = continuous;
        // Top and bottom are exchanged: the face that looks down is above.
        for (Index n = s.w.body.nodes[s.plate].begin; n < s.w.body.nodes[s.plate].end; ++n) {
            Real& z = s.w.nodes.position[n][2];
            z = z < -0.05 ? 0 : -0.001;
        }
        s.w.find(h);
        Real least = 1, normals = 1;
        for (std::size_t i = 0; i < s.w.contacts.size(); ++i) {
            if (s.w.contacts.kind[i] != ContactKind::point_triangle ||
                s.w.contacts.stencil[i].node[0] != s.w.body.nodes[s.spike].begin)
                continue;
            least = std::min(least, std::abs(s.w.contacts.gap[i]));
            normals = std::min(normals, s.w.contacts.normal[i][2]);
        }
        // Unless the surfaces are known to be apart, the point counts as inside and is pushed out to the other side.
        CHECK(normals == Approx(continuous ? 1 : -1));
        if (continuous) CHECK(least < 1e-12);
    }
}

TEST_CASE("two edges that would go through each other become a contact although the surface is hollow at one of them",
          "[unit]") {
    // A valley along x with a rising bottom, and above it a short ridge across. No rule for close features lets a
    // valley touch.
    CollisionWorld w;
    const auto roof = [&](const Vec3& along, const Vec3& across, Real z, Real apex) {
        const Vec3 at(0, 0, z), rise(0, 0, 0.05);
        const std::vector<Vec3> x{at - 0.5 * along, at + 0.5 * along, at + 0.5 * across + rise,
                                  at - 0.5 * across + rise, Vec3(0, 0, apex)};
        return test::SolidMesh{x, {{0, 1, 2, 4}, {1, 0, 3, 4}}};
    };
    const Index valley = w.add_solid(roof(Vec3::UnitX(), Vec3::UnitY(), 0, -0.5), w.at(Vec3::Zero()), shell);
    w.add_solid(roof(-0.2 * Vec3::UnitY(), 0.2 * Vec3::UnitX(), 0.03, 0.5), w.at(Vec3::Zero()), shell);
    const std::vector<Vec3> still(w.nodes.position.size(), Vec3::Zero());
    for (Index n = 0; n < 2; ++n) w.nodes.velocity[w.body.nodes[valley].begin + n] = {0, 0, 50};
    w.measure_speed();
    w.find(h);
    REQUIRE(w.pairs.state[0] == PairState::apart);
    REQUIRE(find_crossings(*w.executor, w.inputs(), w.settings, h, w.nodes.velocity, still, w.pairs, w.crossings) > 0);
    use_crossings(w.pairs, w.crossings);
    const auto crossing = std::find_if(w.crossings.row.begin(), w.crossings.row.end(), [](const ContactRow& row) {
        return row.kind == ContactKind::edge_edge && row.point.norm() < 0.05;
    });
    REQUIRE(crossing != w.crossings.row.end());
    CHECK(std::abs(crossing->normal[2]) == Approx(1));
    CHECK(std::find(w.contacts.key.begin(), w.contacts.key.end(), crossing->key) == w.contacts.key.end());
    w.find(h);
    CHECK(std::find(w.contacts.key.begin(), w.contacts.key.end(), crossing->key) != w.contacts.key.end());
}

TEST_CASE("find_contacts tests all features that a test of every feature finds to cross", "[unit][long]") {
    // Balls near each other get a speed and then a change of it, smaller or larger than find_contacts accounts for.
    const Real change = GENERATE(Real(0.3), Real(120));
    CAPTURE(change);
    std::size_t crossings = 0;
    for (std::uint64_t seed = 1; seed <= 120; ++seed) {
        std::array<CollisionWorld, 2> world;
        for (CollisionWorld& w : world) {
            test::Random random{seed};
            w.settings.use_budgets = &w == &world[0];
            const test::SolidMesh ball = test::ball_mesh(0.5, 3);
            for (int i = 0; i < 3; ++i)
                w.add_solid(ball, w.at(Vec3(1.03 * i, 0.02 * i, 0.03 * i), random.rotation()), shell);
            const auto accelerate = [&](Real speed) {
                for (std::size_t b = 0; b < 3; ++b) {
                    const Vec3 aim = speed * random.vector();
                    for (Index n = w.body.nodes[b].begin; n < w.body.nodes[b].end; ++n)
                        w.nodes.velocity[n] += aim + 0.2 * speed * random.vector();
                }
                w.measure_speed();
            };
            accelerate(40);
            w.find(h);
            for (const PairState state : w.pairs.state) REQUIRE(state == PairState::apart);
            accelerate(change);
            w.crossings.extends_lists = false;
            const std::vector<Vec3> none(w.nodes.position.size(), Vec3::Zero());
            find_crossings(*w.executor, w.inputs(), w.settings, h, w.nodes.velocity, none, w.pairs, w.crossings);
            use_crossings(w.pairs, w.crossings);
        }
        const CollisionWorld &thrifty = world[0], &thorough = world[1];
        REQUIRE(thrifty.crossings.row.size() == thorough.crossings.row.size());
        CHECK(thrifty.crossings.tested == thorough.crossings.tested);
        for (std::size_t i = 0; i < thorough.crossings.row.size(); ++i) {
            CHECK(thrifty.crossings.row[i].key == thorough.crossings.row[i].key);
            CHECK(thrifty.crossings.row[i].stencil.weight == thorough.crossings.row[i].stencil.weight);
            CHECK(thrifty.crossings.row[i].gap == thorough.crossings.row[i].gap);
        }
        crossings += thorough.crossings.row.size();
    }
    CHECK(crossings > 30);
}

}  // namespace skerry::test::find_crossings_test
