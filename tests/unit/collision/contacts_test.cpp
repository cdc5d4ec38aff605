#include "systems/collision/find_contacts.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <limits>
#include <set>

#include "systems/collision/inputs/contact_key.h"
#include "systems/collision/narrow/edge_edge_contact.h"
#include "tests/support/collision_world.h"

namespace skerry::test::contacts_test {

using test::CollisionWorld;

namespace {

constexpr Real h = 1e-4;

Real weight_sum(const Stencil& s) {
    return s.weight[0] + s.weight[1] + s.weight[2] + s.weight[3];
}

void check_rows(const CollisionWorld& w) {
    const ContactTable& c = w.contacts;
    for (std::size_t i = 0; i < c.size(); ++i) {
        if (i > 0) CHECK(c.key[i - 1] < c.key[i]);
        CHECK(c.normal[i].norm() == Approx(1).epsilon(1e-12));
        CHECK(weight_sum(c.stencil[i]) == Approx(c.kind[i] == ContactKind::point_collider ? 1 : 0).margin(1e-12));
        for (std::size_t a = 1; a < 4; ++a)
            if (c.stencil[i].weight[a] == 0) CHECK(c.stencil[i].node[a] == c.stencil[i].node[0]);
        // The stencil applied to positions gives the connection between the two surfaces.
        if (c.kind[i] != ContactKind::point_collider) {
            Vec3 connection = Vec3::Zero();
            for (std::size_t a = 0; a < 4; ++a)
                connection += c.stencil[i].weight[a] * w.nodes.position[c.stencil[i].node[a]];
            CHECK(connection.dot(c.normal[i]) == Approx(c.distance[i]).margin(1e-12));
        }
        CHECK(c.impulse[i] == Vec3::Zero());
        CHECK(c.region[i] == no_index);
        CHECK(c.state[i] == ContactState::open);
    }
}

/// Two boxes, one on the other with a gap between the contact shells.
struct Stack {
    CollisionWorld w;
    Index lower, upper;

    Stack(Real gap, Real turn = 0, const Vec3& shift = Vec3::Zero(), const Mat3& frame = Mat3::Identity()) {
        Mat3 spin = Mat3::Identity();
        spin.topLeftCorner<2, 2>() << std::cos(turn), -std::sin(turn), std::sin(turn), std::cos(turn);
        const test::SolidMesh mesh = test::box_mesh({2, 2, 2}, {1, 1, 1});
        lower = w.add_solid(mesh, w.at(Vec3::Zero(), frame), 0.01, {0.9, 0.4, 0.1});
        upper = w.add_solid(mesh, w.at(frame * (shift + Vec3(0, 0, 1.01 + gap)), frame * spin), 0.01, {0.4, 0.1, 0.3});
    }
};

}  // namespace

TEST_CASE("a box resting on an equal box touches it at all points, along the axis, with the right gap", "[unit]") {
    test::Random random(31);
    for (int trial = 0; trial < 4; ++trial) {
        const Mat3 frame = trial == 0 ? Mat3(Mat3::Identity()) : random.rotation();
        const Real gap = trial % 2 ? 0.0 : 1e-4;
        Stack s(gap, 0, Vec3::Zero(), frame);
        s.w.find(h);
        check_rows(s.w);
        const ContactTable& c = s.w.contacts;
        // Corners lie over corners: each of the 9 points of either face must be held.
        std::set<Index> held;
        for (std::size_t i = 0; i < c.size(); ++i) {
            CHECK(c.gap[i] == Approx(gap).margin(1e-12));
            CHECK(c.distance[i] == Approx(gap + 0.01).margin(1e-12));
            const bool upper_first = c.first_body[i] == s.upper;
            CHECK(c.second_body[i] == (upper_first ? s.lower : s.upper));
            CHECK((c.normal[i] - frame * Vec3(0, 0, upper_first ? 1 : -1)).norm() < 1e-9);
            if (c.kind[i] == ContactKind::point_triangle) held.insert(c.stencil[i].node[0]);
            CHECK(c.collider[i] == no_index);
            CHECK(c.static_friction[i] == Approx(std::sqrt(0.9 * 0.4)));
            CHECK(c.dynamic_friction[i] == Approx(std::sqrt(0.4 * 0.1)));
            CHECK(c.restitution[i] == 0.3);
        }
        CHECK(held.size() == 18);
        if (trial == 0) CHECK(c.size() == 18);  // without rounding no contact is found twice
    }
}

TEST_CASE("a turned box on a box has its crossing edges in contact", "[unit]") {
    Stack s(0, 3.14159265358979323846 / 4);
    s.w.find(h);
    check_rows(s.w);
    const ContactTable& c = s.w.contacts;
    int crossings = 0;
    for (std::size_t i = 0; i < c.size(); ++i) {
        CHECK(c.gap[i] == Approx(0).margin(1e-12));
        CHECK(std::abs(c.normal[i][2]) == Approx(1).epsilon(1e-12));
        crossings += c.kind[i] == ContactKind::edge_edge;
    }
    // The eight corners of the octagon that two squares share. Edges inside the faces are covered by the points.
    CHECK(crossings == 8);
}

TEST_CASE("a box pressed into a box is pushed out through the face", "[unit]") {
    // With the second shift, points lie exactly behind the diagonals of the other box.
    for (const Vec3& shift : {Vec3(0.13, 0.07, 0), Vec3(0.25, 0.25, 0)}) {
        Stack s(-0.02, 0, shift);  // surfaces overlap by 0.01
        s.w.find(h);
        check_rows(s.w);
        const ContactTable& c = s.w.contacts;
        CHECK(c.size() >= 4);
        for (std::size_t i = 0; i < c.size(); ++i) {
            CHECK(c.distance[i] == Approx(-0.01).margin(1e-12));
            CHECK(c.gap[i] == Approx(-0.02).margin(1e-12));
            CHECK(c.normal[i][2] == Approx(c.first_body[i] == s.upper ? 1 : -1).epsilon(1e-9));
        }
    }
}

TEST_CASE("a point on a thin plate is not pushed out through the plate's other side", "[unit]") {
    CollisionWorld w;
    // The plate is thinner than the depth of the search for overlap (a quarter of an edge).
    w.add_solid(test::box_mesh({4, 4, 1}, {4, 4, 0.1}), w.at(Vec3::Zero()), 0.01);
    const Index box = w.add_solid(test::box_mesh({1, 1, 1}, {1, 1, 1}), w.at({0.2, 0.1, 0.05 + 0.01 + 0.5}), 0.01);
    w.find(h);
    check_rows(w);
    CHECK(w.contacts.size() >= 4);
    for (std::size_t i = 0; i < w.contacts.size(); ++i)
        CHECK(w.contacts.normal[i][2] == Approx(w.contacts.first_body[i] == box ? 1 : -1).epsilon(1e-9));
}

TEST_CASE("a corner pressed in beside an edge leaves through the nearest face only", "[unit]") {
    CollisionWorld w;
    w.add_solid(test::box_mesh({2, 2, 2}, {1, 1, 1}), w.at(Vec3::Zero()), 0.01);
    // A corner points down into the top face, 0.03 deep and 0.05 from the side. Both depths are small; the top is
    // nearer.
    const Vec3 tip(0.45, 0.05, 0.47);
    std::vector<Vec3> points{tip, tip + Vec3(0.2, 0, 0.5), tip + Vec3(-0.1, 0.2, 0.5), tip + Vec3(-0.1, -0.2, 0.5)};
    const test::SolidMesh spike{points, {{0, 1, 2, 3}}};
    w.add_solid(spike, w.at(Vec3::Zero()), 0.01);
    w.find(h);
    int of_tip = 0;
    for (std::size_t i = 0; i < w.contacts.size(); ++i) {
        if (w.contacts.kind[i] != ContactKind::point_triangle || w.contacts.stencil[i].node[0] != w.body.nodes[1].begin)
            continue;
        ++of_tip;
        CHECK(w.contacts.normal[i][2] == Approx(1));
        CHECK(w.contacts.distance[i] == Approx(-0.03));
    }
    CHECK(of_tip == 1);
}

TEST_CASE("a point off an edge or a corner is held by one triangle, along the line to it", "[unit]") {
    for (const Vec3& direction : {Vec3(1, 0, 1), Vec3(1, 1, 1), Vec3(1, -1, 1), Vec3(-1, 0, 1)}) {
        CollisionWorld w;
        w.add_solid(test::box_mesh({2, 2, 2}, {1, 1, 1}), w.at(Vec3::Zero()), 0.02);
        const Vec3 out = direction.normalized();
        const Vec3 tip = 0.5 * direction + Vec3(0, direction[1] == 0 ? 0.1 : 0, 0) + 0.02 * out;
        Vec3 u = out.cross(Vec3(0.3, 0.5, -0.2)).normalized(), v = out.cross(u);
        const test::SolidMesh spike{{tip, tip + out + 0.3 * u, tip + out + 0.3 * v, tip + out - 0.3 * u - 0.3 * v},
                                    {{0, 1, 2, 3}}};
        const Index b = w.add_solid(spike, w.at(Vec3::Zero()), 0.02);
        w.find(h);
        int of_tip = 0;
        for (std::size_t i = 0; i < w.contacts.size(); ++i) {
            if (w.contacts.kind[i] != ContactKind::point_triangle ||
                w.contacts.stencil[i].node[0] != w.body.nodes[b].begin)
                continue;
            ++of_tip;
            CHECK((w.contacts.normal[i] - out).norm() < 1e-9);
            CHECK(w.contacts.gap[i] == Approx(0).margin(1e-12));
        }
        CHECK(of_tip == 1);
    }
}

TEST_CASE("surfaces that touch exactly, without a contact distance, are in contact", "[unit]") {
    CollisionWorld w;
    const test::SolidMesh mesh = test::box_mesh({2, 2, 2}, {1, 1, 1});
    w.add_solid(mesh, w.at(Vec3::Zero()), 0);
    const Index upper = w.add_solid(mesh, w.at({0.1, 0.2, 1}), 0);
    w.find(h);
    check_rows(w);
    CHECK(w.contacts.size() >= 8);
    for (std::size_t i = 0; i < w.contacts.size(); ++i) {
        CHECK(w.contacts.gap[i] == Approx(0).margin(1e-12));
        CHECK(w.contacts.normal[i][2] == Approx(w.contacts.first_body[i] == upper ? 1 : -1).epsilon(1e-9));
    }
}

TEST_CASE("a ball on a plane touches it below, with the plane's velocity and the combined surface", "[unit]") {
    CollisionWorld w;
    const Index ball = w.add_solid(test::ball_mesh(1, 4), w.at({0, 0, 1.01}), 0.02, {0.9, 0.4, 0.1});
    const Index plane = w.add_collider(ColliderShape::plane, Vec3::Zero(), w.at(Vec3::Zero()));
    w.collider.motion[plane].velocity = {1, 2, 3};
    w.collider.motion[plane].angular_velocity = {0, 0, 2};
    w.find(h);
    check_rows(w);
    REQUIRE(w.contacts.size() >= 1);
    const ContactTable& c = w.contacts;
    CHECK(c.kind[0] == ContactKind::point_collider);
    CHECK(c.gap[0] == Approx(0).margin(1e-12));  // half of the body's contact distance
    CHECK(c.normal[0] == Vec3(0, 0, 1));
    CHECK(c.first_body[0] == ball);
    CHECK(c.second_body[0] == no_index);
    CHECK(c.collider[0] == plane);
    CHECK((c.surface_velocity[0] - (Vec3(1, 2, 3) + Vec3(0, 0, 2).cross(c.point[0]))).norm() < 1e-12);
    CHECK(c.static_friction[0] == Approx(0.9));  // the plane has no surface properties
    CHECK(c.restitution[0] == 0.1);

    w.collider.surface[plane] = {0.4, 0.1, 0.6};
    w.find(h);
    CHECK(w.contacts.static_friction[0] == Approx(0.6));
    CHECK(w.contacts.dynamic_friction[0] == Approx(0.2));
    CHECK(w.contacts.restitution[0] == 0.6);

    w.collider.surface[plane] = {-1, -1, 0.6};  // negative: the friction of the body is used
    w.find(h);
    CHECK(w.contacts.static_friction[0] == Approx(0.9));
    CHECK(w.contacts.restitution[0] == 0.6);
}

TEST_CASE("a point in the corner of a bucket touches floor and wall", "[unit]") {
    CollisionWorld w;
    const Vec3 corner(0.49, 0, 0.01);
    const test::SolidMesh spike{
        {corner, corner + Vec3(-0.3, 0, 0.1), corner + Vec3(-0.2, 0.1, 0.3), corner + Vec3(-0.2, -0.1, 0.3)},
        {{0, 1, 3, 2}}};
    w.add_solid(spike, w.at(Vec3::Zero()), 0.02);
    w.add_collider(ColliderShape::bucket, {0.5, 1, 0.1}, w.at(Vec3::Zero()));
    w.find(h);
    check_rows(w);
    REQUIRE(w.contacts.size() == 2);
    CHECK((w.contacts.normal[0] - Vec3(0, 0, 1)).norm() < 1e-12);
    CHECK((w.contacts.normal[1] - Vec3(-1, 0, 0)).norm() < 1e-12);
}

TEST_CASE("a mesh collider is touched through its kinematic body and keeps the collider's surface", "[unit]") {
    CollisionWorld w;
    const Index ball = w.add_solid(test::box_mesh({1, 1, 1}, {1, 1, 1}), w.at({0.1, 0.05, 0.51}), 0.02, {0.9, 0.4, 0});
    const std::vector<Vec3> sheet{{-5, -5, 0}, {5, -5, 0}, {5, 5, 0}, {-5, 5, 0}};
    const Index mesh = w.add_kinematic(sheet, {{{0, 1, 2}, no_index}, {{0, 2, 3}, no_index}}, 0);
    const Index collider = w.body.collider[mesh];
    w.collider.surface[collider] = {0.4, 0.1, 0.6};
    w.find(h);
    check_rows(w);
    REQUIRE(w.contacts.size() >= 4);
    std::set<Index> held;
    for (std::size_t i = 0; i < w.contacts.size(); ++i) {
        CHECK(w.contacts.normal[i][2] == Approx(1));
        CHECK(w.contacts.gap[i] == Approx(0).margin(1e-12));
        CHECK(w.contacts.key[i].pair == collider_pair_key(w.body.slot[ball], w.collider.slot[collider]));
        CHECK(w.contacts.first_body[i] == ball);
        CHECK(w.contacts.second_body[i] == mesh);
        CHECK(w.contacts.collider[i] == collider);
        CHECK(w.contacts.static_friction[i] == Approx(0.6));
        held.insert(w.contacts.stencil[i].node[0]);
    }
    CHECK(held.size() == 4);
}

TEST_CASE("a contact without a moving node is left out, a pinned body on a free one is kept", "[unit]") {
    Stack s(0);
    const auto pin = [&](Index b) {
        for (Index n = s.w.body.nodes[b].begin; n < s.w.body.nodes[b].end; ++n) s.w.nodes.inverse_mass[n] = 0;
    };
    s.w.add_collider(ColliderShape::plane, Vec3::Zero(), s.w.at({0, 0, -0.505}));
    pin(s.lower);
    s.w.find(h);
    CHECK(s.w.contacts.size() == 18);  // with the upper box, none with the plane
    pin(s.upper);
    s.w.find(h);
    CHECK(s.w.contacts.size() == 0);
}

TEST_CASE("contacts reach as far as the step can close, not much further", "[unit]") {
    for (Real speed : {0.0, 1.0, 100.0}) {
        const auto contacts_at = [&](Real gap) {
            Stack s(gap);
            for (Index n = s.w.body.nodes[s.upper].begin; n < s.w.body.nodes[s.upper].end; ++n)
                s.w.nodes.velocity[n] = {0, 0, -speed};
            s.w.find(h);  // max_speed is still zero, as in the first step of a new body
            return s.w.contacts.size();
        };
        CHECK(contacts_at(h * speed + 0.5e-3) == 18);
        CHECK(contacts_at(3 * h * speed + 2e-3) == 0);
    }
}

TEST_CASE("a position that is not a number makes no contact and stops nothing", "[unit]") {
    for (Real bad : {std::numeric_limits<Real>::quiet_NaN(), std::numeric_limits<Real>::infinity()}) {
        Stack s(0);
        s.w.add_collider(ColliderShape::plane, Vec3::Zero(), s.w.at({0, 0, -0.505}));
        s.w.find(h);
        REQUIRE(s.w.contacts.size() == 27);
        const Index broken = s.w.body.nodes[s.lower].begin + 4;  // bottom node in the middle
        s.w.nodes.position[broken][0] = bad;
        s.w.find(h);
        for (const bool budgets : {true, false}) {
            s.w.settings.use_budgets = budgets;
            s.w.find(h);
            for (std::size_t i = 0; i < s.w.contacts.size(); ++i) {
                CHECK(std::isfinite(s.w.contacts.gap[i]));
                for (Index n : s.w.contacts.stencil[i].node) CHECK(n != broken);
            }
        }
        for (Vec3& x : s.w.nodes.position) x.setConstant(bad);
        s.w.find(h);
        CHECK(s.w.contacts.size() == 0);
    }
}

TEST_CASE("a folded body touches itself, a thin one does not touch its own other side", "[unit]") {
    CollisionWorld w;
    const Index b = w.add_solid(test::box_mesh({8, 2, 1}, {8, 2, 0.2}), w.at(Vec3::Zero()), 0.02);
    w.body.self_contact[b] = 1;
    w.find(h);
    CHECK(w.contacts.size() == 0);
    // Bend it into a U: two arms 0.02 apart, the middle turned about an axis along y.
    constexpr Real pi = 3.14159265358979323846;
    for (Index n = w.body.nodes[b].begin; n < w.body.nodes[b].end; ++n) {
        const Vec3 rest = w.nodes.rest_position[n];
        const Real half = 0.11;  // from the axis of the bend to the middle of the body [m]
        const Real angle = std::clamp(rest[0], -1.0, 1.0) * pi / 2;
        const Real arm = std::max(std::abs(rest[0]) - 1, 0.0);
        const Real radius = half - rest[2];
        w.nodes.position[n] = Vec3(-arm, rest[1], 0) + radius * Vec3(std::cos(angle), 0, std::sin(angle));
    }
    w.search.body_valid_until.clear();
    w.find(h);
    check_rows(w);
    CHECK(w.contacts.size() >= 12);
    for (std::size_t i = 0; i < w.contacts.size(); ++i) {
        CHECK(w.contacts.gap[i] == Approx(0).margin(1e-9));
        CHECK(std::abs(w.contacts.normal[i][2]) == Approx(1));
    }
}

TEST_CASE("a body touches itself neither at rest nor when it is squeezed evenly to a tenth", "[unit]") {
    for (const test::SolidMesh& mesh : {test::box_mesh({8, 2, 1}, {8, 2, 0.2}), test::ball_mesh(1, 4)}) {
        CollisionWorld w;
        const Index b = w.add_solid(mesh, w.at(Vec3::Zero()), 0.02);
        w.body.self_contact[b] = 1;
        for (Real squeeze : {1.0, 0.5, 0.1}) {
            for (std::size_t n = 0; n < w.nodes.position.size(); ++n)
                w.nodes.position[n] = squeeze * w.nodes.rest_position[n];
            w.search.body_valid_until.clear();
            w.find(h);
            REQUIRE(w.pairs.size() == 1);
            CHECK(w.pairs.state[0] == PairState::apart);
            CHECK(w.contacts.size() == 0);
        }
    }
}

TEST_CASE("two ridges that have passed each other are pushed back, however flat they are", "[unit]") {
    const PairScale scale{0.02, 0.02, 1, 0.25, 0.02, 0.25};
    for (Real bend : {0.025, 0.05, 0.5, 2.0})
        for (Real height : {0.01, 0.0, -0.005, -0.015}) {
            INFO("bend " << bend << ", height " << height);
            // A roof with a ridge along x that faces up, and one with a ridge along y that faces down, `height` above
            // it.
            const Real fall = 0.5 * std::tan(bend / 2);
            std::vector<Vec3> x{{-0.5, 0, 0}, {0.5, 0, 0}, {0, 0.5, -fall}, {0, -0.5, -fall}};
            for (std::size_t i = 0; i < 4; ++i) x.push_back({x[i][1], x[i][0], height - x[i][2]});
            SurfaceTables surface;
            const std::vector<BoundaryTriangle> roof{{{0, 1, 2}, no_index}, {{1, 0, 3}, no_index}};
            append_surface(roof, 0, no_index, surface);
            append_surface(roof, 4, no_index, surface);
            const auto ridge = [&](Index a) {
                Index e = 0;
                while (surface.edges.node[e] != std::array<Index, 2>{a, a + 1}) ++e;
                return e;
            };
            for (Real closing : {0.0, 0.004}) {
                const EdgeEdgeContact contact =
                    edge_edge_contact(surface, x, ridge(4), ridge(0), scale, 0.02 + closing, Surfaces::may_overlap);
                REQUIRE(contact.touching);
                CHECK(contact.distance == Approx(height).margin(1e-14));
                CHECK((contact.normal - Vec3(0, 0, 1)).norm() < 1e-12);
            }
        }
}

TEST_CASE("an edge that lies on two edges of a face is held by the sharper, though the flatter lets it come nearer",
          "[unit]") {
    const PairScale scale{0.02, 0.02, 1, 0.25, 0.03, 0.25};
    constexpr Real near = 0.0201;
    const Vec3 a(0, 0, 0), common(1, 0, 0), b(0.4, 0.9, 0);
    // The surface beyond an edge of the face falls away by the bend.
    const auto beyond = [](const Vec3& from, const Vec3& to, Real bend) {
        const Vec3 outward = (to - from).cross(Vec3::UnitZ());
        return Vec3((from + to) / 2 + outward * std::cos(bend) - Vec3::UnitZ() * std::sin(bend) * outward.norm());
    };
    for (Real flat_bend : {0.0101, 0.012, 0.016, 0.0199})
        for (Real sharp_bend : {0.021, 0.1, 1.0})
            for (Real on_flat : {0.05, 0.3, 0.5, 0.7, 0.95})  // measured from the common corner
                for (Real on_sharp : {0.05, 0.5, 0.95}) {
                    INFO("bends " << flat_bend << ", " << sharp_bend << ", at " << on_flat << ", " << on_sharp);
                    const Vec3 first = common + on_flat * (a - common), second = common + on_sharp * (b - common);
                    // A sharp ridge over both, each end far beyond the face.
                    const auto contacts = [&](Real height, Real other_height) {
                        const Vec3 p = first + height * Vec3::UnitZ(), q = second + other_height * Vec3::UnitZ();
                        const Vec3 along = (q - p).normalized(), side = along.cross(Vec3::UnitZ());
                        const Vec3 begin = p - 2 * along, end = q + 2 * along;
                        const std::vector<Vec3> x{a,
                                                  common,
                                                  b,
                                                  beyond(a, common, flat_bend),
                                                  beyond(common, b, sharp_bend),
                                                  begin,
                                                  end,
                                                  (begin + end) / 2 + side + 0.3 * Vec3::UnitZ(),
                                                  (begin + end) / 2 - side + 0.3 * Vec3::UnitZ()};
                        SurfaceTables surface;
                        append_surface(
                            std::vector<BoundaryTriangle>{
                                {{0, 1, 2}, no_index}, {{1, 0, 3}, no_index}, {{2, 1, 4}, no_index}},
                            0, no_index, surface);
                        append_surface(std::vector<BoundaryTriangle>{{{0, 1, 2}, no_index}, {{1, 0, 3}, no_index}}, 5,
                                       no_index, surface);
                        const auto edge = [&](Index m, Index n) {
                            Index e = 0;
                            while (surface.edges.node[e] != std::array<Index, 2>{m, n}) ++e;
                            return e;
                        };
                        const auto with = [&](Index e) {
                            return edge_edge_contact(surface, x, edge(5, 6), e, scale, near, Surfaces::apart);
                        };
                        return std::pair{with(edge(0, 1)), with(edge(1, 2))};
                    };
                    const auto even = contacts(scale.contact_distance, scale.contact_distance);
                    REQUIRE(even.first.touching);
                    REQUIRE(even.second.touching);
                    CHECK(even.first.slack > 0);
                    CHECK(even.second.slack < 1e-12);
                    const auto held = contacts(scale.contact_distance - even.first.slack, scale.contact_distance);
                    CHECK(held.second.touching);
                }
}

}  // namespace skerry::test::contacts_test
