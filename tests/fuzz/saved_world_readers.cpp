// Fuzz targets for saved worlds: raw bytes, and valid files with wrong values, which are then advanced by a step.
#include <algorithm>
#include <cmath>

#include "engine/world/save/world_file.h"
#include "engine/world/tuning.h"
#include "engine/world/world_state.h"
#include "readers.h"
#include "skerry/visual.h"
#include "skerry/world.h"
#include "tests/support/world_file_damage.h"

namespace skerry::test {

namespace {

/// A world with a row in every small table: two kinds of elements, contacts, a held node, a mesh collider, a script,
/// a visual surface.
World small_world(ElementKind element) {
    World world = tuned_world({.backend = Backend::serial, .threads = 1}, {.sleep_speed = 0.01});
    const auto soft = world.add_material({.young_modulus = 2e4});
    const auto stiff = world.add_material({.young_modulus = 2e5, .model = MaterialModel::corotational});
    Mesh box = mesh::box({0.1, 0.1, 0.1}, {1, 1, 2});
    for (std::size_t t = 0; t < box.tetrahedra.size(); ++t) box.label.push_back(t < 3 ? 1 : 0);
    world.add_collider(Plane{});
    SurfaceMesh lid;
    lid.nodes = {{-0.1, -0.1, 0}, {0.1, -0.1, 0}, {0, 0.1, 0}, {0, 0, 0.1}};
    lid.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    world.add_collider(lid, {.position = {0.15, 0, 0.01}, .motion = {.velocity = {-0.05, 0, 0}}});
    world.add_collider(Capsule{0.02, 0.1},
                       {.position = {-0.08, 0, 0.05},
                        .motion = {.keys = {{0, {-0.08, 0, 0.05}, {0, 0, 0}}, {1, {-0.07, 0, 0.05}, {0, 0.5, 0}}}}});
    const auto lower = world.add_body(
        box, {.material = soft, .materials = {{1, stiff}}, .position = {0, 0, 0.051}, .element = element});
    world.add_body(box, {.material = soft,
                         .materials = {{1, stiff}},
                         .position = {0.01, 0, 0.153},
                         .self_contact = true,
                         .element = element});
    world.attach(lower, std::vector<Index>{0});
    Visuals(world).set(lower, {.nodes = lid.nodes,
                               .triangles = lid.triangles,
                               .texture_points = {{0, 0}, {1, 0}, {0, 1}},
                               .texture_corners = std::vector<std::array<Index, 3>>(4, {0, 1, 2}),
                               .materials = {{.name = "skin", .texture = "skin.png"}},
                               .material = {0, no_index, 0, 0}});
    world.advance(0.02);
    return world;
}

struct Sample {
    std::vector<std::byte> bytes;
    std::vector<ValuesInFile> sets;

    explicit Sample(ElementKind element) : bytes(small_world(element).to_bytes()), sets(values_in(bytes)) {}
};

const Sample& sample(ElementKind element) {
    static const Sample smoothed(ElementKind::smoothed), linear(ElementKind::linear);
    return element == ElementKind::linear ? linear : smoothed;
}

/// Advances by one step, which may be refused.
void move(World& world) {
    const Settings& settings = world.settings();
    constexpr int few_sweeps = 1000;
    if (settings.max_iterations > few_sweeps || !(world.stable_step() > 0)) return;
    const Real safety = WorldAccess::state_of(world).model.tuning.step_safety;
    const Real step = std::min({world.stable_step() * safety, settings.step_size.value_or(1), 1.0});
    if (!world.advance(step).ok()) return;
    for (const BodyHandle body : world.bodies())
        for (const Vec3& x : world.positions(body)) expect_valid(x.allFinite(), "a position that is not finite");
}

}  // namespace

void read_saved_bytes(FileBytes bytes) {
    try {
        World::from_bytes(std::as_bytes(bytes));
    } catch (const SceneError&) {
    }
}

void read_saved_values_bytes(FileBytes bytes) {
    if (bytes.empty()) return;
    const Sample& start = sample(bytes[0] % 2 != 0 ? ElementKind::linear : ElementKind::smoothed);
    std::vector<std::byte> file = start.bytes;
    constexpr std::size_t code_bytes = 5;
    for (FileBytes rest = bytes.subspan(1); rest.size() >= code_bytes; rest = rest.subspan(code_bytes)) {
        const std::size_t set = rest[0] + 256u * rest[1], place = rest[2] + 256u * rest[3];
        change_value(start.sets[set % start.sets.size()], place, rest[4], file);
    }
    renew_checksum(file);
    try {
        World world = read_world("file", file, {}, false).world;
        move(world);
        world.to_bytes();
    } catch (const SceneError&) {
    }
}

std::string sample_saved_world() {
    const std::vector<std::byte>& bytes = sample(ElementKind::smoothed).bytes;
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace skerry::test
