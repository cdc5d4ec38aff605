// Loading of damaged worlds and of other files: a message that names the file, never a crash, never another world.
#include <catch2/catch.hpp>
#include <cstring>
#include <fstream>
#include <iterator>
#include <utility>

#include "components/split_mix.h"
#include "components/types.h"
#include "engine/world/save/world_file.h"
#include "skerry/cavity.h"
#include "skerry/joint.h"
#include "skerry/load.h"
#include "tests/support/draws.h"
#include "tests/support/lively_scene.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/world_file_damage.h"

namespace skerry::test::world_file_test {

using Catch::Matchers::Contains;

namespace {

/// A world with rows in every table.
World full_world() {
    World world = lively_scene({});
    REQUIRE(world.advance(0.21).ok());
    REQUIRE(world.contacts().size() > 0);
    return world;
}

using Bytes = std::vector<std::byte>;

struct FileOfWorld {
    TemporaryFolder folder;
    std::string path;
    Bytes bytes;

    explicit FileOfWorld(const World& world) : path((folder.path() / "world.skerry").string()) {
        world.save(path);
        const std::string content = content_of(path);
        const auto begin = reinterpret_cast<const std::byte*>(content.data());
        bytes.assign(begin, begin + content.size());
    }
    static std::string content_of(const std::filesystem::path& path) {
        std::ifstream in(path, std::ios::binary);
        return {std::istreambuf_iterator<char>(in), {}};
    }
    /// Error message of World::load for the content.
    std::string refusal(std::string_view content) const {
        std::ofstream(path, std::ios::binary).write(content.data(), static_cast<std::streamsize>(content.size()));
        return message_of([&] { World::load(path); });
    }
    std::string refusal(std::span<const std::byte> content) const {
        return refusal(std::string_view(reinterpret_cast<const char*>(content.data()), content.size()));
    }
    /// Error message for the file with one changed number.
    std::string refusal_with(std::string_view column, std::size_t place, Index value) const {
        const std::vector<ValuesInFile> sets = values_in(bytes);
        const auto set = std::ranges::find(sets, column, &ValuesInFile::path);
        REQUIRE(set != sets.end());
        Bytes changed = bytes;
        std::memcpy(changed.data() + set->begin + place * sizeof value, &value, sizeof value);
        renew_checksum(changed);
        return refusal(changed);
    }
};

}  // namespace

TEST_CASE("a saved world that was cut off anywhere is refused by its size", "[unit][long]") {
    const FileOfWorld saved(full_world());
    SplitMix random(1);
    for (int i = 0; i < 200; ++i) {
        const std::size_t size = random.next() % saved.bytes.size();
        const std::string refusal = saved.refusal(std::span(saved.bytes).first(size));
        INFO(refusal);
        CHECK(refusal.starts_with(saved.path + ": found "));
        if (size >= start_bytes) {
            CHECK_THAT(refusal, Contains(std::to_string(size) + " bytes"));
            CHECK_THAT(refusal, Contains(std::to_string(saved.bytes.size())));
        }
    }
    Bytes longer = saved.bytes;
    longer.push_back(std::byte{0});
    CHECK_THAT(saved.refusal(longer), Contains("the file has extra bytes at its end"));
    CHECK(saved.refusal(saved.bytes).empty());
}

TEST_CASE("a saved world of which any bit was turned over is refused", "[unit][long]") {
    const FileOfWorld saved(full_world());
    SplitMix random(2);
    Bytes bytes = saved.bytes;
    const auto turn_over = [&](std::size_t at, int bit) {
        bytes[at] ^= std::byte{1} << bit;
        const std::string refusal = saved.refusal(bytes);
        CAPTURE(at, bit);
        CHECK(refusal.starts_with(saved.path + ": found "));
        bytes[at] = saved.bytes[at];
    };
    for (std::size_t at = 0; at < start_bytes; at += 3) turn_over(at, static_cast<int>(at % 8));
    for (int i = 0; i < 300; ++i) turn_over(random.next() % bytes.size(), static_cast<int>(random.next() % 8));
    CHECK(saved.refusal(bytes).empty());
    Bytes small = World().to_bytes();
    for (std::size_t at = 0; at < small.size(); ++at) {
        const std::byte before = std::exchange(small[at], small[at] ^ std::byte{1} << at % 8);
        CAPTURE(at);
        CHECK_THROWS_AS(World::from_bytes(small), SceneError);
        small[at] = before;
    }
}

TEST_CASE("a saved world with any bytes in its header is refused, or is the same world, if its checksum is right",
          "[unit]") {
    const World world;
    const Bytes bytes = world.to_bytes();
    std::uint64_t length = 0;  // of the header [bytes]
    std::memcpy(&length, bytes.data(), sizeof length);
    SplitMix random(4);
    int taken = 0;
    const int tries = draws(10000);
    for (int i = 0; i < tries; ++i) {
        Bytes changed = bytes;
        for (std::uint64_t remaining = 1 + random.next() % 3; remaining > 0; --remaining) {
            // half of the changes are digits, so that shapes and offsets stay readable
            const std::size_t at = random.next() % (sizeof length + length);
            const std::uint64_t digit = '0' + random.next() % 10;
            changed[at] = static_cast<std::byte>(random.next() % 2 ? digit : random.next() % 256);
        }
        renew_checksum(changed);
        CAPTURE(i);
        try {
            const std::uint64_t hash = World::from_bytes(changed).state_hash();
            CHECK(hash == world.state_hash());
            ++taken;
        } catch (const SceneError&) {
        }
    }
    CHECK(taken < tries / 10);
}

TEST_CASE("a file of another kind or version is refused, and the error names it", "[unit]") {
    const FileOfWorld saved(full_world());
    CHECK_THAT(saved.refusal(""), Contains("found a file of another kind, expected a world that Skerry saved"));
    CHECK_THAT(saved.refusal("{\"bodies\": []}"), Contains("expected a world that Skerry saved, version 30"));
    CHECK_THAT(saved.refusal(std::span(saved.bytes).subspan(start_bytes)), Contains("a file of another kind"));
    Bytes other = saved.bytes;
    const auto begin = reinterpret_cast<const char*>(other.data());
    const std::string name = "version 30";
    const auto place = std::search(begin, begin + other.size(), name.begin(), name.end()) - begin;
    other[static_cast<std::size_t>(place) + 8] = std::byte{'1'};
    CHECK_THAT(saved.refusal(other), Contains("found version 10, expected version 30"));
    CHECK_THAT(saved.refusal("Skerry world, version 24\nAn HDF5 file of 8000 bytes begins at byte 512.\n"),
               Contains("found version 24, expected version 30"));
    CHECK_THROWS_WITH(World::load(saved.folder.path()), Contains("found a folder or device"));
    CHECK_THROWS_WITH(World::load(saved.folder.path() / "none"), Contains("no such file"));
}

TEST_CASE("a saved world whose header is not that of a saved world is refused, although its checksum is right",
          "[unit]") {
    const FileOfWorld saved(full_world());
    const auto content = reinterpret_cast<const char*>(saved.bytes.data());
    const std::string_view whole(content, saved.bytes.size());
    // Replaces a text in the header by a text of the same length.
    const auto refusal = [&](const std::string& before, const std::string& after) {
        const std::size_t place = whole.find(before);
        REQUIRE(place != std::string_view::npos);
        REQUIRE(before.size() == after.size());
        Bytes bytes = saved.bytes;
        std::memcpy(bytes.data() + place, after.data(), after.size());
        renew_checksum(bytes);
        const std::string message = saved.refusal(bytes);
        CHECK(message.starts_with(saved.path + ": "));
        return message;
    };
    const std::string position = R"("nodes/position":{"dtype":"F64","shape":[)";
    const std::size_t at = whole.find(position) + position.size();
    const std::string rows(whole.substr(at, whole.find(']', at) - at));
    const std::string offsets = rows + R"(],"data_offsets":[)";
    const std::size_t begin = whole.find(position + offsets) + position.size() + offsets.size();
    const std::string range(whole.substr(begin, whole.find(']', begin) - begin));

    CHECK_THAT(refusal("nodes/position", "nodes/velocity"), Contains("expected an array with another name"));
    CHECK_THAT(refusal("nodes/position", "nodes/Position"), Contains("nodes: position: found nothing, expected rows"));
    CHECK_THAT(refusal("search/rebase", "search/REBASE"), Contains("search: rebase: found nothing"));
    CHECK_THAT(refusal(position, R"("nodes/position":{"dtype":"I64","shape":[)"),
               Contains("expected one of the types"));
    CHECK_THAT(refusal(position, R"("nodes/position":{"dtype":"U64","shape":[)"),
               Contains("nodes: position: found rows of 3 integers of 8 bytes, expected rows of 3 reals of 8 bytes"));
    CHECK_THAT(refusal(position, R"("nodes/position":{"dtype":"F64","shave":[)"), Contains("expected ,\"shape\":["));
    CHECK_THAT(refusal(position + rows, position + (rows[0] == '9' ? "8" : "9") + rows.substr(1)),
               Contains("within the file"));
    CHECK_THAT(refusal(position + rows, position + std::string(rows.size() - 2, '9') + ",0"),
               Contains("expected a shape of at most 2147483647"));
    CHECK_THAT(refusal(position + offsets + range, position + offsets + " " + range.substr(1)),
               Contains("header: found other text") && Contains("],\"data_offsets\":["));
    const std::string gap = position + offsets + (range[0] == '9' ? "8" : "9") + range.substr(1);
    CHECK_THAT(refusal(position + offsets + range, gap), Contains("header: found other text"));
    CHECK_THAT(refusal("\"note\":\"\"}", "\"note\":\"}\""), Contains("header: found other text at byte"));
    CHECK_THAT(refusal("\"note\"", "\"npte\""), Contains("expected ,\"note\":\""));
}

TEST_CASE("a saved world with an array that no column has is refused", "[unit]") {
    const Bytes bytes = World().to_bytes();
    const SavedFile file("file", bytes);
    std::vector<ArraySource> arrays;
    for (const auto& [name, array] : file.arrays())
        arrays.push_back({name, array.number, array.rows, array.width, array.bytes.data(), array.row_bytes()});
    CHECK(World::from_bytes(saved_bytes(arrays, file.texts())).state_hash() == World().state_hash());
    arrays.push_back({"nodes/colour", NumberType::uint8, 0, 3, nullptr, 3});
    CHECK_THROWS_WITH(World::from_bytes(saved_bytes(arrays, file.texts())),
                      Contains("nodes: colour: found an array, expected no array of this name"));
}

TEST_CASE("a world in memory has the bytes of its file, and is read like a file", "[unit]") {
    const World world = full_world();
    const FileOfWorld saved(world);
    const Bytes bytes = world.to_bytes();
    CHECK(bytes == saved.bytes);
    World again = World::from_bytes(bytes, {.threads = 2});
    CHECK(again.state_hash() == world.state_hash());
    CHECK(again.settings().threads == 2);
    CHECK(World::from_bytes(bytes).to_bytes() == bytes);
    CHECK_THROWS_WITH(World::from_bytes(std::span(bytes).first(bytes.size() - 1)),
                      Contains("saved world: found " + std::to_string(bytes.size() - 1) + " bytes"));
    CHECK_THROWS_WITH(World::from_bytes({}), Contains("saved world: found a file of another kind"));
    CHECK_THROWS_WITH(again.advance(0.01,
                                    [&](const StepReport&) {
                                        again.to_bytes();
                                        return true;
                                    }),
                      Contains("to_bytes"));
}

TEST_CASE("a world is saved only if it can be loaded", "[unit]") {
    World empty;
    REQUIRE(empty.advance(0.1).ok());
    CHECK(World::from_bytes(empty.to_bytes()).state_hash() == empty.state_hash());
    World world;
    const BodyHandle body = world.add_body(mesh::ball(0.05, 4), {.material = world.add_material({}), .name = "ball"});
    world.set_velocity(body, {1e200, 0, 0});  // its energy is infinite
    CHECK_FALSE(world.advance(0.01).ok());
    const TemporaryFolder folder;
    const auto file = folder.path() / "world.skerry";
    CHECK_THROWS_WITH(world.save(file),
                      Contains("save: ") && Contains("found inf at row") && Contains("finite numbers"));
    CHECK_THROWS_WITH(world.to_bytes(), Contains("found inf at row"));
    CHECK_FALSE(std::filesystem::exists(file));
}

TEST_CASE("a text that is saved with a world comes back unchanged", "[unit]") {
    World world;
    const TemporaryFolder folder;
    // The last bytes are not UTF-8: a byte of Latin-1, a form that is too long, a surrogate, and a cut-off character.
    const std::string note = "a \"quoted\" \\ path\n\tand \x01 \xc3\xa9 \xf0\x9f\x8c\x8d";
    const std::string bytes = " \xe9 \xc0\xaf \xed\xa0\x80 \xf4\x90\x80\x80 \xe2\x82";
    save_world(WorldAccess::state_of(world), {note + bytes}, folder.path() / "w");
    CHECK(load_world(folder.path() / "w", {}).note.text == note + bytes);
    const std::string header = FileOfWorld::content_of(folder.path() / "w");
    CHECK_THAT(header, Contains("\xc3\xa9 \xf0\x9f\x8c\x8d \\u00e9 \\u00c0\\u00af \\u00ed\\u00a0\\u0080 "
                                "\\u00f4\\u0090\\u0080\\u0080 \\u00e2\\u0082\"}"));
}

TEST_CASE("all numbers of a saved world are aligned in memory", "[unit]") {
    const Bytes bytes = full_world().to_bytes();
    for (const ValuesInFile& values : values_in(bytes)) {
        CAPTURE(values.path);
        CHECK(values.begin % values.number_bytes == 0);
    }
}

TEST_CASE(
    "wrong values in a saved world whose checksum is right are refused, or change nothing that the next step sees",
    "[unit][slow]") {
    const World world = full_world();
    const FileOfWorld saved(world);
    const std::vector<ValuesInFile> sets = values_in(saved.bytes);
    REQUIRE(sets.size() > 150);
    int refused = 0, named = 0, taken = 0;
    SplitMix random(3);
    for (const ValuesInFile& values : sets)
        for (int i = 0; i < 4; ++i) {
            Bytes bytes = saved.bytes;
            change_value(values, random.next(), static_cast<unsigned>(random.next() % 10), bytes);
            renew_checksum(bytes);
            CAPTURE(values.path);
            const std::string refusal = saved.refusal(bytes);
            const std::size_t slash = values.path.rfind('/');
            refused += !refusal.empty();
            named += refusal.find(values.path.substr(slash + 1)) != std::string::npos;
            if (!refusal.empty()) {
                CHECK(refusal.starts_with(saved.path + ": "));
                continue;
            }
            ++taken;
            CHECK(World::load(saved.path).state_hash() == world.state_hash());
        }
    CHECK(refused > taken);
    CHECK(named > 100);
}

TEST_CASE("a saved world in which values do not fit together is refused by name", "[unit]") {
    const FileOfWorld saved(full_world());
    const std::vector<ValuesInFile> sets = values_in(saved.bytes);
    const auto refusal = [&](const std::string& path, std::size_t place, unsigned choice) {
        const auto set = std::ranges::find(sets, path, &ValuesInFile::path);
        REQUIRE(set != sets.end());
        Bytes bytes = saved.bytes;
        change_value(*set, place, choice, bytes);
        renew_checksum(bytes);
        return saved.refusal(bytes);
    };
    constexpr unsigned denormal = 6, huge = 7, none = 7, infinite = 8, minus_one = 8;
    CHECK_THAT(refusal("nodes/position", 4, none), Contains("nodes: position: found nan at row 1, expected finite"));
    CHECK_THAT(refusal("nodes/velocity", 0, infinite), Contains("nodes: velocity: found inf at row 0"));
    CHECK_THAT(refusal("elements/material", 3, huge), Contains("elements: material: found 2147483647 at row 3"));
    CHECK_THAT(refusal("element_nodes/node", 9, minus_one), Contains("element_nodes: node: found node -1 at row 1"));
    CHECK_THAT(refusal("bodies/nodes", 1, huge), Contains("at row 1, expected a range that begins at 2147483647"));
    CHECK_THAT(refusal("bodies/kind", 0, 3), Contains("bodies: kind: found 3 at row 0, expected 0 to 1"));
    CHECK_THAT(refusal("handles/bodies/row", 0, huge), Contains("handles/bodies: row: found 2147483647"));
    CHECK_THAT(refusal("meshes/tetrahedra/item", 0, huge), Contains("meshes: tetrahedra: found node 2147483647"));
    CHECK_THAT(refusal("pairs/candidates/first", 0, huge), Contains("pairs/candidates: first: found"));
    CHECK_THAT(refusal("last_step/contacts/stencil/node", 0, huge),
               Contains("last_step/contacts/stencil: node: found"));
    CHECK_THAT(refusal("warm_start/step", 0, denormal),
               Contains("warm_start: step: found 4.94e-324, expected a time > 0"));
    CHECK_THAT(refusal("records/body_built", 0, none), Contains("records: body_built"));
    CHECK_THAT(refusal("settings/method", 0, 5), Contains("settings: method: found 255"));
    CHECK_THAT(refusal("settings/tolerance", 0, 1), Contains("tolerance: found -1"));
    CHECK_THAT(refusal("materials/young_modulus", 0, 2), Contains("state_hash"));
}

TEST_CASE("a saved world in which two motors share their keys is refused", "[unit]") {
    World world;
    const MaterialHandle material = world.add_material({});
    for (const Real x : {0.0, 1.0}) {
        const BodyHandle body =
            world.add_body(mesh::box({0.1, 0.1, 0.1}, {1, 1, 1}),
                           {.material = material, .position = {x, 0, 0}, .dynamics = BodyDynamics::rigid});
        const JointMotor motor{.strength = 1, .keys = {{.time = 0, .speed = 1}, {.time = 1, .speed = 2}}};
        Joints(world).add({.kind = JointKind::hinge, .first = body, .motor = motor});
    }
    const FileOfWorld saved(world);
    CHECK(saved.refusal(saved.bytes).empty());
    const std::vector<ValuesInFile> sets = values_in(saved.bytes);
    const auto keys = std::ranges::find(sets, "joints/motor_keys", &ValuesInFile::path);
    REQUIRE(keys != sets.end());
    Bytes bytes = saved.bytes;
    std::memcpy(bytes.data() + keys->begin + sizeof(Range), bytes.data() + keys->begin, sizeof(Range));
    renew_checksum(bytes);
    CHECK_THAT(saved.refusal(bytes), Contains("joints: motor_keys: found a range of keys that begins at row 0"));
}

TEST_CASE("a saved world with a load on a node that does not exist, or with wrong ranges, is refused", "[unit]") {
    World world;
    const BodyHandle body = world.add_body(mesh::box({0.1, 0.1, 0.1}, {1, 1, 1}), {.material = world.add_material({})});
    Loads(world).add(ForceLoad{body, {1, 2}, {1, 0, 0}, TimeTable({{0, 0}, {1, 1}})});
    world.add_collider(Plane{}, {.motion = {.keys = {{0, {0, 0, 0}}, {1, {0, 0, 1}}}}});
    const FileOfWorld saved(world);
    CHECK(saved.refusal(saved.bytes).empty());
    CHECK_THAT(saved.refusal_with("loads/node", 1, 8),
               Contains("loads: node: found a node that the body does not have"));
    CHECK_THAT(saved.refusal_with("loads/nodes", 1, 3), Contains("loads: nodes: found a range that does not exist"));
    CHECK_THAT(saved.refusal_with("loads/nodes", 1, 1), Contains("loads: node: found 2 rows, expected 1"));
    CHECK_THAT(saved.refusal_with("loads/scale_keys", 0, 1), Contains("loads: scale_keys"));
    CHECK_THAT(saved.refusal_with("loads/body", 0, -1), Contains("loads: body: found -1"));
    CHECK_THAT(
        saved.refusal_with("bodies/nodes", 1, 7),
        Contains("bodies: nodes: found ranges that end at 7, expected ranges that end at 8, the number of rows"));
    CHECK_THAT(saved.refusal_with("colliders/script/key_end", 0, 3),
               Contains("colliders/script: key_end: found 0 to 3 at row 0, expected a range of the 2 rows of "
                        "colliders/keyframe"));
}

TEST_CASE("a saved world with a pipe whose bodies or ends do not fit its cavities is refused", "[unit]") {
    World world;
    const MaterialHandle material = world.add_material({});
    std::vector<CavityHandle> cavities;
    for (const Real x : {0.0, 1.0}) {
        const BodyHandle body =
            world.add_body(mesh::box({0.1, 0.1, 0.1}, {1, 1, 1}), {.material = material, .position = {x, 0, 0}});
        cavities.push_back(Cavities(world).add(
            {.body = body, .faces = std::vector{world.surface(body)[0]}, .filling = GasFilling{}, .volume = 1e-3}));
    }
    Cavities(world).add(PipeSettings{.first = cavities[0], .second = cavities[1], .conductance = 1e-9});
    Cavities(world).add(PipeSettings{.first = cavities[1], .conductance = 1e-9});
    const FileOfWorld saved(world);
    CHECK(saved.refusal(saved.bytes).empty());
    CHECK_THAT(saved.refusal_with("pipes/first_body", 0, 1),
               Contains("pipes: first_body: found 1 at row 0, expected 0"));
    CHECK_THAT(saved.refusal_with("pipes/first_body", 1, -1),
               Contains("pipes: first_body: found -1 at row 1, expected 1"));
    CHECK_THAT(saved.refusal_with("pipes/second_body", 0, -1),
               Contains("pipes: second_body: found -1 at row 0, expected 1"));
    CHECK_THAT(saved.refusal_with("pipes/second_body", 1, 0),
               Contains("pipes: second_body: found 0 at row 1, expected -1"));
    CHECK_THAT(saved.refusal_with("pipes/second", 1, 0), Contains("pipes: second: found 0 at row 1, expected 1"));
}

TEST_CASE("a saved world with a self-contact but without positions of its last search is refused", "[unit]") {
    const FileOfWorld saved(full_world());
    const std::vector<ValuesInFile> sets = values_in(saved.bytes);
    Bytes bytes = saved.bytes;
    const auto values = [&](const std::string& path) {
        const auto set = std::ranges::find(sets, path, &ValuesInFile::path);
        REQUIRE(set != sets.end());
        return *set;
    };
    // The first pair becomes a self-contact of its first body.
    const ValuesInFile first = values("pairs/first"), second = values("pairs/second");
    std::memcpy(bytes.data() + second.begin, bytes.data() + first.begin, first.number_bytes);
    constexpr unsigned self = 2;
    change_value(values("pairs/kind"), 0, self, bytes);
    renew_checksum(bytes);
    CHECK_THAT(saved.refusal(bytes), Contains("pairs: self_origin: found 0 rows"));
}

TEST_CASE("a world that cannot be written stays, and so does the file before it", "[unit]") {
    const World world = full_world();
    const FileOfWorld saved(world);
    std::filesystem::create_directory(saved.path + ".part");  // blocks the path of the temporary file
    CHECK_THROWS_WITH(world.save(saved.path), Contains(saved.path));
    CHECK(World::load(saved.path).state_hash() == world.state_hash());
    CHECK_THROWS_WITH(world.save(saved.folder.path()), Contains("a folder"));
}

TEST_CASE("chosen dynamics and their reasons are saved in files", "[scene]") {
    const TemporaryFolder folder;
    World world;
    const auto steel = world.add_material({.young_modulus = 2e11});
    const auto body = world.add_body(mesh::box(Vec3::Constant(0.1), {2, 2, 2}),
                                     {.material = steel, .dynamics = BodyDynamics::automatic, .name = "block"});
    const std::filesystem::path file = folder.path() / "world.skerry";
    world.save(file);
    World again = World::load(file);
    CHECK(again.dynamics_choice(body).reason == DynamicsReason::cost);
    CHECK(again.dynamics_choice(body).explicit_cost == world.dynamics_choice(body).explicit_cost);
    REQUIRE(again.report().dynamics_choices.size() == 1);
    CHECK(again.report().dynamics_choices[0].name == "block");
    CHECK(again.report().dynamics_choices[0].message() == world.report().dynamics_choices[0].message());
    CHECK(again.report().dynamics_choices[0].message().find("implicit: ") == 0);
}

}  // namespace skerry::test::world_file_test
