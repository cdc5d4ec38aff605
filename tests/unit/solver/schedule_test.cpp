// The memory of regions and its only effect: the order in which they are started.
#include <catch2/catch.hpp>

#include "systems/solver/schedule_regions.h"
#include "tests/support/contact_scene.h"

namespace skerry::test::solver_schedule_test {

namespace {

/// Regions with these numbers of contacts, one after the other.
RegionTable regions_of(const std::vector<Index>& sizes) {
    RegionTable regions;
    regions.contacts.offset.push_back(0);
    for (const Index size : sizes) regions.contacts.offset.push_back(regions.contacts.offset.back() + size);
    for (Index i = 0; i < regions.contacts.offset.back(); ++i) regions.contacts.item.push_back(i);
    regions.order.resize(sizes.size());
    regions.iterations.resize(sizes.size());
    return regions;
}

std::vector<ContactKey> keys(std::size_t count, std::uint64_t first = 0) {
    std::vector<ContactKey> key;
    for (std::size_t i = 0; i < count; ++i) key.push_back({first + i, 7});
    return key;
}

const std::unique_ptr<Executor> one = make_executor(Backend::serial, 1), two = make_executor(Backend::threads, 2);

std::vector<Index> order_of(const RegionTable& regions) {
    return {regions.order.begin(), regions.order.end()};
}

}  // namespace

TEST_CASE("a region is known by its first contact, with the sweeps it took and how long it has kept its contacts",
          "[unit][solver]") {
    SolverMemory memory;
    RegionMemory& data = memory.data();
    RegionTable regions = regions_of({3, 20, 1});
    const std::vector<ContactKey> key = keys(24);
    for (const Index sweeps : {10, 20}) {
        recall_regions(*one, key, data, regions);
        CHECK(regions.id[1] == key[3]);
        regions.iterations[0] = 1;
        regions.iterations[1] = sweeps;
        remember_regions(data, regions);
    }
    CHECK(data.history.sweeps[0] == 1);
    CHECK(data.history.sweeps[1] == Approx(0.7 * 10 + 0.3 * 20));
    CHECK(data.history.age[1] == 1);

    // Contact 23 no longer starts a region, contact 2 is a region of its own, and the last region starts at contact 3.
    RegionTable changed = regions_of({2, 1, 21});
    recall_regions(*one, key, data, changed);
    CHECK(data.present.sweeps[0] == 1);
    CHECK(data.present.age[0] == 0);                          // lost a contact
    CHECK(data.present.sweeps[1] < 0);                        // never seen
    CHECK(data.present.sweeps[2] == data.history.sweeps[1]);  // kept its first contact
}

TEST_CASE("a region that took many sweeps is started before a larger one that took few", "[unit][solver]") {
    SolverMemory memory;
    RegionTable regions = regions_of({50, 1, 100, 4, 5, 1});
    const std::vector<ContactKey> key = keys(161);
    recall_regions(*one, key, memory.data(), regions);
    schedule_regions(*two, {}, memory.data(), regions);
    CHECK(order_of(regions) == std::vector<Index>{2, 0, 4, 3, 1, 5});
    for (const Index r : {0, 1, 2, 3, 4, 5}) regions.iterations[r] = r == 0 ? 100 : 1;
    remember_regions(memory.data(), regions);
    recall_regions(*one, key, memory.data(), regions);
    schedule_regions(*two, {}, memory.data(), regions);
    CHECK(order_of(regions) == std::vector<Index>{0, 2, 4, 3, 1, 5});
}

TEST_CASE("each of many regions is remembered, whatever came and went before it", "[unit][solver]") {
    constexpr Index count = 2000;  // several blocks
    SolverMemory memory;
    RegionMemory& data = memory.data();
    RegionTable regions = regions_of(std::vector<Index>(count, 2));
    const std::vector<ContactKey> key = keys(2 * count);
    recall_regions(*two, key, data, regions);
    for (Index r = 0; r < count; ++r) regions.iterations[r] = r;
    remember_regions(data, regions);
    // Every third region is gone, and a new one follows each tenth.
    std::vector<ContactKey> next;
    std::vector<Index> was;
    for (Index r = 0; r < count; ++r) {
        if (r % 3 == 0) continue;
        next.insert(next.end(), {key[2 * r], key[2 * r + 1]});
        was.push_back(r);
        if (r % 10 != 0) continue;
        next.insert(next.end(), {{key[2 * r + 1].pair, 8}, {key[2 * r + 1].pair, 9}});
        was.push_back(no_index);
    }
    RegionTable changed = regions_of(std::vector<Index>(was.size(), 2));
    recall_regions(*two, next, data, changed);
    for (std::size_t r = 0; r < was.size(); ++r) {
        CHECK(changed.id[r] == next[2 * r]);
        CHECK(data.present.sweeps[r] == static_cast<Real>(was[r]));  // no_index: -1, never seen
    }
}

TEST_CASE("tasks hold every region once, and are small enough to share", "[unit][solver]") {
    SolverMemory memory;
    RegionTable regions = regions_of(std::vector<Index>(2000, 3));
    recall_regions(*one, {}, memory.data(), regions);
    for (const int workers : {1, 2, 8}) {
        schedule_regions(*make_executor(Backend::threads, workers), {}, memory.data(), regions);
        const Column<RegionTask>& task = memory.data().task;
        REQUIRE(task.size() >= static_cast<std::size_t>(workers));
        Index end = 0;
        for (const RegionTask& t : task) {
            CHECK(t.begin == end);
            CHECK(t.end > t.begin);
            end = t.end;
        }
        CHECK(end == 2000);
    }
    CHECK(regions.id.empty());
}

TEST_CASE("the use of remembered data changes no bit of the result", "[determinism][solver]") {
    ContactScene scene;
    for (int k = 0; k < 12; ++k) add_sheets(scene, 3 + k % 5, 0.5, static_cast<unsigned>(k));
    const std::vector<ContactKey> key = keys(scene.stencil.size());
    RegionInputs inputs = scene.inputs();
    inputs.key = key;
    SolverMemory memory;
    const auto executor = make_executor(Backend::serial, 1);
    const SolvedScene fresh = scene.solve();
    for (int step = 0; step < 3; ++step) {
        SolvedScene again = scene.solve();
        again.impulse = scene.impulse;
        again.velocity = scene.velocity;
        again.push_out.assign(scene.velocity.size(), Vec3::Zero());
        solve_regions(*executor, inputs, {}, scene.h, memory, again.regions,
                      {again.impulse, again.velocity, again.push_out});
        CHECK(again.impulse == fresh.impulse);
        CHECK(again.velocity == fresh.velocity);
        CHECK(memory.data().history.age[0] == step);
    }
}

}  // namespace skerry::test::solver_schedule_test
