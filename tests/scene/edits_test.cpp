// Bodies and colliders are added, removed and changed while others move and rest. Known pairs of the others stay valid,
// resting neighbours wake, and no other pairs are searched.
#include <catch2/catch.hpp>
#include <functional>
#include <optional>

#include "engine/world/tuning.h"
#include "tests/support/lively_scene.h"
#include "tests/support/random.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/worlds.h"

namespace skerry::test::edits_test {

namespace {

constexpr Real radius = 0.05;  // of the balls [m]

World empty_world(bool budgets, int threads = 1, Real sleep_speed = 0.05) {
    return tuned_world({.threads = threads, .sleep_time = 0.02},
                       {.sleep_speed = sleep_speed, .contact_budgets = budgets});
}

/// A pile in a world with random edits: every possible change of bodies and colliders between steps.
class EditedPile {
public:
    EditedPile(World empty, std::uint64_t seed) : world(std::move(empty)), random_(seed) {
        soft_ = world.add_material({.young_modulus = 2e4, .friction = 0.5, .damping = 30});
        world.add_collider(Plane{});
        for (int i = 0; i < 6; ++i) add_body({0.12 * (i % 3), 0.03 * i, 0.056 + 0.12 * (i / 3)});
    }
    EditedPile(const EditedPile& other, World copy)
        : world(std::move(copy)),
          random_(other.random_),
          soft_(other.soft_),
          bodies_(other.bodies_),
          colliders_(other.colliders_),
          held_(other.held_) {}

    void edit() {
        for (int edits = below(4) - 1; edits > 0; --edits) edit_once();
    }
    /// Copies that continue from a clone and from a file.
    EditedPile clone() const { return {*this, world.clone()}; }
    EditedPile saved_and_loaded() const {
        const TemporaryFolder folder;
        world.save(folder.path() / "world.skerry");
        return {*this, World::load(folder.path() / "world.skerry")};
    }

    World world;

private:
    struct PlacedCollider {
        ColliderHandle handle;
        Real room;  // free distance that it needs around its middle [m]
    };

    int below(int count) { return std::min(count - 1, static_cast<int>((random_.number() + 1) / 2 * count)); }
    template <class Handle>
    Handle any(const std::vector<Handle>& handles) {
        return handles[static_cast<std::size_t>(below(static_cast<int>(handles.size())))];
    }
    template <class Handle>
    Handle take(std::vector<Handle>& handles) {
        const auto at = handles.begin() + below(static_cast<int>(handles.size()));
        const Handle taken = *at;
        handles.erase(at);
        return taken;
    }
    void add_body(const Vec3& position) {
        bodies_.push_back(world.add_body(mesh::ball(radius, 3), {.material = soft_, .position = position}));
    }
    /// A position above everything, so that nothing starts inside something else.
    Vec3 above() {
        Real top = 0.3;
        for (const BodyHandle body : bodies_) top = std::max(top, world.center_of_mass(body).z());
        return {0.15 + 0.15 * random_.number(), 0.1 * random_.number(), top + 0.15};
    }
    /// A random position in the pile, or nothing if something is within `distance` [m]
    std::optional<Vec3> beside(Real distance) {
        const Vec3 position(0.15 + 0.4 * random_.number(), 0.3 * random_.number(), 0.15 + 0.15 * random_.number());
        if (world.nearest_point(position, distance)) return std::nullopt;
        return position;
    }
    /// A position just above another body that has no other neighbours, or else above everything.
    Vec3 close_above(BodyHandle body) {
        const BodyHandle under = any(bodies_);
        const Vec3 position = world.center_of_mass(under) + Vec3(0, 0, 2.15 * radius);
        const bool is_free = under != body && !world.nearest_point(position, 1.12 * radius, {.except_bodies = {body}});
        return is_free ? position : above();
    }

    void edit_once() {
        switch (below(12)) {
            case 0:
                if (bodies_.size() < 9) add_body(above());
                break;
            case 1:
                if (bodies_.size() > 3) world.remove(take(bodies_));
                break;
            case 2:
            case 3: {
                const int kind = below(4);
                const Real room = kind == 0 ? 0.042 : 0.08;
                const std::optional<Vec3> position = beside(room);
                if (!position || colliders_.size() > 5) break;
                const ColliderSettings at{.position = *position, .motion = {.velocity = 0.1 * random_.vector()}};
                if (kind == 0) colliders_.push_back({world.add_collider(Sphere{0.04}, at), room});
                if (kind == 1) colliders_.push_back({world.add_collider(Box{{0.1, 0.1, 0.05}}, at), room});
                if (kind > 1)
                    colliders_.push_back(
                        {world.add_collider(mesh::boundary(mesh::box({0.1, 0.1, 0.05}, {2, 2, 1})), at), room});
                break;
            }
            case 4:
                if (!colliders_.empty()) world.remove(take(colliders_).handle);
                break;
            case 5:
                if (!colliders_.empty()) {
                    const PlacedCollider moved = any(colliders_);
                    if (const auto position = beside(moved.room)) world.set_pose(moved.handle, {.position = *position});
                }
                break;
            case 6:
                if (!colliders_.empty()) world.set_velocity(any(colliders_).handle, Vec3::Zero());
                break;
            case 7: {
                const BodyHandle body = any(bodies_);
                world.set_velocities(body, std::vector<Vec3>(world.velocities(body).size(), 0.5 * random_.vector()));
                break;
            }
            case 8: {
                const BodyHandle body = any(bodies_);
                std::vector<Vec3> x(world.positions(body).begin(), world.positions(body).end());
                const Vec3 shift = close_above(body) - world.center_of_mass(body);
                for (Vec3& node : x) node += shift;
                world.set_positions(body, x);
                break;
            }
            case 9: {
                const BodyHandle first = any(bodies_), second = any(bodies_);
                if (first != second) world.set_collision(first, second, !world.may_collide(first, second));
                break;
            }
            case 10:
                if (!colliders_.empty()) world.set_collision_groups(any(colliders_).handle, 1 + below(2), 1);
                break;
            default:
                if (!held_.empty() && world.alive(held_.back()))
                    world.remove(take(held_));
                else
                    held_ = {world.attach(any(bodies_), std::array<Index, 3>{0, 1, 2})};
        }
    }

    Random random_;
    MaterialHandle soft_;
    std::vector<BodyHandle> bodies_;
    std::vector<PlacedCollider> colliders_;
    std::vector<AttachmentHandle> held_;
};

/// `side` x `side` balls that rest on a floor, too far apart to touch.
struct Field {
    World world;
    MaterialHandle soft;
    ColliderHandle floor;
    std::vector<BodyHandle> balls;

    explicit Field(int side, Real apart = 0.11) : world(empty_world(true)) {
        soft = world.add_material({.young_modulus = 2e4, .friction = 0.5, .damping = 30});
        floor = world.add_collider(Plane{});
        for (int i = 0; i < side * side; ++i)
            balls.push_back(
                world.add_body(mesh::ball(radius, 3),
                               {.material = soft, .position = {apart * (i % side), apart * (i / side), 0.0505}}));
        for (int i = 0; i < 100 && world.report().asleep < balls.size(); ++i) REQUIRE(world.advance(0.01).ok());
        REQUIRE(world.report().asleep == balls.size());
    }
    std::size_t asleep() const { return world.report().asleep; }
};

struct Searches {
    std::uint64_t broad, pairs;
};

/// Number of searches caused by a change and by the step after it.
Searches searches_of(World& world, const std::function<void()>& change) {
    const WorldReport before = world.report();
    change();
    REQUIRE(world.advance(0.5 * world.stable_step()).ok());
    const WorldReport after = world.report();
    return {after.broad_searches - before.broad_searches, after.pair_searches - before.pair_searches};
}

SurfaceMesh small_block() {
    return mesh::boundary(mesh::box({0.04, 0.04, 0.04}, {1, 1, 1}));
}

}  // namespace

TEST_CASE("a world that is changed at random goes on as one that searches everything in every step", "[scene][long]") {
    std::uint64_t contacts = 0, asleep = 0;
    for (const std::uint64_t seed : {1u, 2u, 3u, 4u, 5u, 6u}) {
        CAPTURE(seed);
        EditedPile pile(empty_world(true, 1, 0.2), seed), twin(empty_world(false, 1, 0.2), seed);
        for (int call = 0; call < 100; ++call) {
            CAPTURE(call);
            pile.edit();
            twin.edit();
            REQUIRE(pile.world.advance(0.01).ok());
            REQUIRE(twin.world.advance(0.01).ok());
            REQUIRE(pile.world.state_hash() == twin.world.state_hash());
            contacts += pile.world.contacts().size();
            asleep += pile.world.report().asleep;
        }
        const WorldReport of_pile = pile.world.report(), of_twin = twin.world.report();
        CHECK(of_pile.pair_searches < of_twin.pair_searches / 4);
        CHECK(of_pile.crossed == 0);
    }
    CHECK(contacts > 3000);
    CHECK(asleep > 50);
}

TEST_CASE("a changed world goes on with the same bits on all threads, cloned, and saved and loaded", "[scene]") {
    EditedPile one(empty_world(true, 1, 0.2), 7), four(empty_world(true, 4, 0.2), 7);
    for (int call = 0; call < 40; ++call) {
        CAPTURE(call);
        one.edit();
        four.edit();
        if (call % 8 == 3) {  // the copies are made after a change and before the next step
            EditedPile copy = one.clone(), loaded = one.saved_and_loaded();
            for (EditedPile* other : {&copy, &loaded}) {
                EditedPile here = one.clone();
                for (int more = 0; more < 2; ++more) {
                    REQUIRE(here.world.advance(5e-3).ok());
                    REQUIRE(other->world.advance(5e-3).ok());
                    REQUIRE(other->world.state_hash() == here.world.state_hash());
                    REQUIRE(other->world.report().pair_searches == here.world.report().pair_searches);
                    here.edit();
                    other->edit();
                }
            }
        }
        REQUIRE(one.world.advance(5e-3).ok());
        REQUIRE(four.world.advance(5e-3).ok());
        REQUIRE(one.world.state_hash() == four.world.state_hash());
    }
}

TEST_CASE("contacts of new or thrown bodies are found in every try of the first step, also after a refused one",
          "[scene]") {
    // A tile without a contact distance falls on a plane. In the same step a cube beside it is pulled further than the
    // list of its pair is valid for, so that the step is tried again.
    enum class Start { added, thrown, refused };
    const Start start = GENERATE(Start::added, Start::thrown, Start::refused);
    CAPTURE(start);
    const auto pull = [](World& world, BodyHandle body, Real force) {
        world.set_loads(body, std::vector<Vec3>(world.positions(body).size(), Vec3(0, 0, force)));
    };
    World world({.gravity = Vec3::Zero()});
    const auto material = world.add_material({});
    world.add_collider(Plane{});
    const auto cube = world.add_body(mesh::box({0.1, 0.1, 0.1}, {1, 1, 1}),
                                     {.material = material, .position = {1, 0, 0.06}, .dynamics = BodyDynamics::rigid});
    const auto tile =
        world.add_body(mesh::box({0.1, 0.1, 0.02}, {1, 1, 1}), {.material = material,
                                                                .position = {0, 0, 0.015},
                                                                .velocity = {0, 0, start == Start::thrown ? 0.0 : -1.0},
                                                                .contact_distance = 0,
                                                                .dynamics = BodyDynamics::rigid});
    const Real dt = 1.0 / 120;
    if (start == Start::thrown) {
        REQUIRE(world.advance(dt).ok());
        world.set_velocity(tile, {0, 0, -1});
    }
    if (start == Start::refused) {
        pull(world, cube, 1e308);
        REQUIRE_FALSE(world.advance(dt).ok());
    }
    pull(world, cube, start == Start::refused ? 0 : 1e4);
    const std::uint64_t searches = world.report().pair_searches;
    const StepReport report = world.advance(dt);
    REQUIRE(report.ok());
    REQUIRE(report.steps == 1);
    if (start != Start::refused) REQUIRE(world.report().pair_searches >= searches + 2);
    CHECK(report.contacts >= 4);
    CHECK(world.center_of_mass(tile).z() > 0.01 - 1e-9);
}

TEST_CASE("removing many objects at once gives the same world as removing them one by one", "[scene]") {
    const auto scene = [] {
        Field field(4, 0.101);
        std::vector<ColliderHandle> blocks;
        for (int i = 0; i < 3; ++i) {
            const Vec3 position(0.1 * i, 0.1, 0.13);
            blocks.push_back(field.world.add_collider(small_block(), {.position = position}));
            field.world.add_collider(Sphere{0.02}, {.position = position + Vec3(0, 0.1, 0)});
        }
        field.world.attach(field.balls[3], std::array<Index, 2>{0, 1});
        field.world.attach(field.balls[9], std::array<Index, 2>{2, 3}, {.keys = {{0, {0, 0, 0}, {0, 0, 0}}}});
        field.world.set_loads(field.balls[5],
                              std::vector<Vec3>(field.world.positions(field.balls[5]).size(), Vec3(0, 0, -1e-3)));
        REQUIRE(field.world.advance(0.01).ok());
        return std::pair(std::move(field), blocks);
    };
    auto [at_once, blocks] = scene();
    auto [one_by_one, others] = scene();
    const auto remove_all = [&](Field& field, const std::vector<ColliderHandle>& colliders, auto&& after_each) {
        for (const int i : {15, 3, 0, 6, 7, 11, 5}) {
            field.world.remove(field.balls[static_cast<std::size_t>(i)]);
            after_each();
        }
        field.world.remove(colliders[1]);
        after_each();
        field.world.remove(colliders[0]);
        after_each();
        // A freed slot is immediately reused for another body.
        const BodyHandle late =
            field.world.add_body(mesh::ball(radius, 3), {.material = field.soft, .position = {0, 0, 0.3}});
        CHECK(late.slot == field.balls[0].slot);
        after_each();
        field.world.remove(field.balls[1]);
        after_each();
        CHECK(field.world.name(late) == "body " + std::to_string(late.slot));
    };
    remove_all(at_once, blocks, [] {});
    remove_all(one_by_one, others, [&] { (void)one_by_one.world.bodies(); });
    const auto slots = [](const World& world) {
        std::vector<std::uint32_t> of_bodies;
        for (const BodyHandle body : world.bodies()) of_bodies.push_back(body.slot);
        return of_bodies;
    };
    CHECK(slots(at_once.world) == slots(one_by_one.world));
    CHECK(at_once.world.bodies().size() == 9);
    CHECK(at_once.world.colliders().size() == 5);
    CHECK(at_once.world.contacts().size() == one_by_one.world.contacts().size());
    CHECK(at_once.world.state_hash() == one_by_one.world.state_hash());
    for (Field* field : {&at_once, &one_by_one}) REQUIRE(field->world.advance(0.05).ok());
    CHECK(at_once.world.state_hash() == one_by_one.world.state_hash());
    CHECK(at_once.world.report().pair_searches == one_by_one.world.report().pair_searches);
}

TEST_CASE("a change searches the pairs of the changed objects only, in worlds of any size", "[scene][long]") {
    std::vector<std::vector<std::uint64_t>> found;
    for (const int side : {3, 9}) {
        Field field(side);
        World& world = field.world;
        ColliderHandle ball, block;
        BodyHandle body;
        const Vec3 on_top(0.11, 0.11, 0.135), beside(0, 0.11, 0.135);
        std::vector<std::uint64_t> of_side;
        // `is_new`: something is near a ball that was not there before, or is not known to be unchanged
        const auto look = [&](bool is_new, const std::function<void()>& change) {
            const Searches searches = searches_of(world, change);
            CHECK(searches.broad == (is_new ? 1 : 0));
            CHECK((searches.pairs > 0) == is_new);
            CHECK(searches.pairs <= 12);
            of_side.push_back(searches.pairs);
        };
        look(true, [&] { ball = world.add_collider(Sphere{0.02}, {.position = on_top}); });
        look(true, [&] { world.set_pose(ball, {.position = beside}); });
        look(true, [&] { world.set_collision_groups(ball, 2, 1); });
        look(false, [&] { world.set_surface_properties(ball, {.friction = 0.1}); });
        look(false, [&] { world.remove(ball); });
        look(true, [&] { block = world.add_collider(small_block(), {.position = on_top}); });
        look(true, [&] { world.set_pose(block, {.position = beside}); });
        look(false, [&] { world.remove(block); });
        look(true, [&] {
            body = world.add_body(mesh::ball(radius, 3), {.material = field.soft, .position = {0.11, 0.11, 0.2}});
        });
        look(true,
             [&] { world.set_velocities(body, std::vector<Vec3>(world.velocities(body).size(), Vec3(0, 0, -1))); });
        look(true, [&] {
            std::vector<Vec3> x(world.positions(body).begin(), world.positions(body).end());
            for (Vec3& node : x) node.z() -= 0.02;
            world.set_positions(body, x);
        });
        look(true, [&] { world.attach(body, std::array<Index, 1>{0}); });
        look(false, [&] {
            world.remove(body);
            for (const int i : {0, 2, 1}) world.remove(field.balls[static_cast<std::size_t>(i)]);
        });
        found.push_back(of_side);
    }
    CHECK(found[0] == found[1]);
}

TEST_CASE("resting bodies beside an added, removed or changed object wake, and no others", "[scene][long]") {
    Field field(5, 0.2);
    World& world = field.world;
    const std::size_t all = field.balls.size();
    const auto rest = [&] {
        for (int i = 0; i < 100 && field.asleep() < world.bodies().size(); ++i) REQUIRE(world.advance(0.01).ok());
        REQUIRE(field.asleep() == world.bodies().size());
    };
    const BodyHandle middle = field.balls[12];
    const Vec3 above_it = world.center_of_mass(middle) + Vec3(0, 0, 0.08), far(0, 0, 2);
    SECTION("a collider that comes, is moved, and goes") {
        for (const bool is_mesh : {false, true}) {
            const ColliderHandle collider = is_mesh ? world.add_collider(small_block(), {.position = above_it})
                                                    : world.add_collider(Sphere{0.025}, {.position = above_it});
            CHECK_FALSE(world.asleep(middle));
            CHECK(field.asleep() == all - 1);
            rest();
            world.set_surface_properties(collider, {.friction = 0.1});
            CHECK(field.asleep() == all - 1);
            rest();
            world.set_pose(collider, {.position = far});
            CHECK_FALSE(world.asleep(middle));
            CHECK(field.asleep() == all - 1);
            rest();
            world.set_pose(collider, {.position = above_it});
            CHECK(field.asleep() == all - 1);
            rest();
            world.remove(collider);
            CHECK_FALSE(world.asleep(middle));
            CHECK(field.asleep() == all - 1);
            rest();
        }
    }
    SECTION("the floor, and a plane far below") {
        const ColliderHandle below = world.add_collider(Plane{.point = {0, 0, -1}});
        CHECK(field.asleep() == all);
        world.remove(field.floor);
        CHECK(field.asleep() == 0);
        REQUIRE(world.advance(0.1).ok());
        CHECK(world.center_of_mass(middle).z() < 0.02);
        CHECK(world.alive(below));
    }
    SECTION("the body under another, removed, moved or let through") {
        const BodyHandle upper =
            world.add_body(mesh::box({0.09, 0.09, 0.03}, {2, 2, 1}),
                           {.material = field.soft, .position = world.center_of_mass(middle) + Vec3(0, 0, 0.068)});
        const auto x = [&] {
            return std::vector<Vec3>(world.positions(middle).begin(), world.positions(middle).end());
        };
        CHECK(field.asleep() == all);
        rest();
        const Real height = world.center_of_mass(upper).z();
        const int kind = GENERATE(0, 1, 2);
        if (kind == 0) world.remove(middle);
        if (kind == 1) {
            std::vector<Vec3> moved = x();
            for (Vec3& node : moved) node.z() += 1;
            world.set_positions(middle, moved);
        }
        if (kind == 2) world.set_collision(upper, middle, false);
        CHECK_FALSE(world.asleep(upper));
        CHECK(field.asleep() >= world.bodies().size() - 2);
        REQUIRE(world.advance(0.05).ok());
        CHECK(world.center_of_mass(upper).z() < height - 0.005);
    }
}

TEST_CASE("a collider put in the way of a resting body pushes it", "[scene]") {
    Field field(2, 0.2);
    for (const bool is_mesh : {false, true}) {
        const BodyHandle ball = field.balls[is_mesh ? 0 : 1];
        const Vec3 at = field.world.center_of_mass(ball) + Vec3(0, 0, 0.075);
        if (is_mesh)
            field.world.add_collider(small_block(), {.position = at, .motion = {.velocity = {0, 0, -0.2}}});
        else
            field.world.add_collider(Sphere{0.02}, {.position = at, .motion = {.velocity = {0, 0, -0.2}}});
        const Real height = field.world.center_of_mass(ball).z();
        REQUIRE(field.world.advance(0.1).ok());  // the ball resumes a part of the vibration that sleep had frozen
        CHECK(field.world.center_of_mass(ball).z() < height - 0.001);
    }
}

TEST_CASE("clusters go on when mesh colliders come and go", "[scene]") {
    World world = thrown_slivers();
    const auto block = world.add_collider(small_block(), {.position = {0, 0, 2}});
    world.add_body(sliver_box(0.1, 6, 0.01, 0.005, 4),
                   {.material = MaterialHandle{0, 0, block.world}, .position = {0.5, 0, 0.06}, .velocity = {0, 0, -3}});
    REQUIRE(world.advance(0.01).ok());
    const std::size_t clusters = world.report().clusters;
    REQUIRE(clusters > 0);
    const TemporaryFolder folder;
    for (const bool removed : {true, false}) {
        World untouched = world.clone();
        if (removed)
            world.remove(block);
        else
            world.add_collider(small_block(), {.position = {0, 0, 3}});
        world.save(folder.path() / "world.skerry");
        World loaded = World::load(folder.path() / "world.skerry");
        for (World* other : {&world, &loaded, &untouched}) REQUIRE(other->advance(0.01).ok());
        CHECK(world.report().clusters == untouched.report().clusters);
        CHECK(loaded.state_hash() == world.state_hash());
        for (const BodyHandle body : world.bodies())
            CHECK(std::ranges::equal(world.positions(body), untouched.positions(body)));
    }
}

}  // namespace skerry::test::edits_test
