// Fuzz targets for mesh files in a world. The world may refuse a mesh that it cannot simulate.
#include <algorithm>
#include <cmath>

#include "readers.h"
#include "skerry/world.h"
#include "tests/support/temporary_folder.h"

namespace skerry::test {

namespace {

const TemporaryFolder& folder() {
    static const TemporaryFolder made;
    return made;
}

std::string file_of(const char* name, FileBytes bytes) {
    return folder().write(name, {reinterpret_cast<const char*>(bytes.data()), bytes.size()}).string();
}

World quiet_world() {
    return World({.step_size = {}, .backend = Backend::serial, .threads = 1});
}

/// Advances the world by one step, which may be refused.
void move(World& world) {
    expect_valid(world.stable_step() > 0, "a stable step that is none");
    world.advance(std::min(world.stable_step(), 1.0));
    for (const BodyHandle body : world.bodies()) {
        expect_valid(std::isfinite(world.mass(body)) && world.center_of_mass(body).allFinite(),
                     "a mass that is not finite");
        for (const Vec3& x : world.positions(body)) expect_valid(x.allFinite(), "a position that is not finite");
    }
}

}  // namespace

void read_body_bytes(FileBytes bytes) {
    try {
        World world = quiet_world();
        world.add_collider(Plane{});
        world.add_body(mesh::read(file_of("body.vtk", bytes)),
                       {.material = world.add_material({}), .contact_distance = {}, .self_contact = true});
        move(world);
    } catch (const SceneError&) {
    }
}

void read_collider_bytes(FileBytes bytes) {
    try {
        World world = quiet_world();
        world.add_collider(mesh::read_surface(file_of("collider.obj", bytes)), {.motion = {}});
        const Mesh box = mesh::box(Vec3::Constant(0.1), {1, 1, 1});
        world.add_body(box, {.material = world.add_material({}), .contact_distance = {}});
        move(world);
    } catch (const SceneError&) {
    }
}

}  // namespace skerry::test
