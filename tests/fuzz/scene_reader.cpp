// Fuzz target for scene files. Scenes are built and advanced by one step unless that costs too much time.
#include <algorithm>
#include <cmath>

#include "engine/scene/scene_file.h"
#include "engine/scene/scene_plan.h"
#include "readers.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/engine/mesh_samples.h"

namespace skerry::test {

namespace {

// Limit on elements and on copies: a few bytes of a valid scene can ask for millions.
constexpr Real most_parts = 4000;

/// The scene's folder with the files that the scenes of the corpus refer to.
const TemporaryFolder& folder() {
    static const TemporaryFolder made;
    static const bool written = [] {
        const Mesh mesh = mesh::box({0.1, 0.2, 0.3}, {1, 1, 1});
        made.write("body.vtk", vtk_file(mesh, false, false));
        made.write("shape.obj", obj_file(mesh::boundary(mesh)));
        made.write("other.json", R"({"materials": {"wood": {"E": 1e6}}})");
        return true;
    }();
    static_cast<void>(written);
    return made;
}

Real elements_of(const MeshEntry& mesh) {
    const auto cubed = [](Real n) { return 6 * n * n * n; };
    if (mesh.box) return 6.0 * mesh.box->cells[0] * mesh.box->cells[1] * mesh.box->cells[2];
    if (mesh.ball) return cubed(mesh.ball->resolution + 1);
    if (mesh.cylinder)
        return cubed(mesh.cylinder->resolution + 1) * (1 + mesh.cylinder->height / mesh.cylinder->radius);
    if (mesh.skittle) return 10 * cubed(mesh.skittle->resolution + 1);
    if (mesh.lathe) {
        Real widest = 0;
        for (const auto& [radius, z] : mesh.lathe->profile) widest = std::max(widest, radius);
        const Real height =
            mesh.lathe->profile.empty() ? 0 : mesh.lathe->profile.back()[1] - mesh.lathe->profile.front()[1];
        return cubed(mesh.lathe->resolution + 1) * (1 + height / widest);
    }
    if (mesh.table) {
        const mesh::TableShape& t = *mesh.table;
        const Real cell = std::min(t.leg / t.cells_per_leg, t.thickness);
        return 6 * (t.length / cell + 2) * (t.width / cell + 2) * (t.height / cell + 2);
    }
    return 100;
}

bool affordable(const SceneFile& scene) {
    Real copies = 0, elements = 0;
    for (const BodyEntry& body : scene.bodies) {
        const Real repeated =
            body.repeat ? Real(1) * body.repeat->count[0] * body.repeat->count[1] * body.repeat->count[2] : 1;
        copies += repeated + static_cast<Real>(body.positions.size());
        constexpr Real of_sphere = 1280;  // elements of the mesh that draws a sphere
        elements += repeated * (body.mesh ? elements_of(*body.mesh) : of_sphere);
    }
    for (const ColliderEntry& collider : scene.colliders)
        if (collider.shape.mesh) elements += elements_of(*collider.shape.mesh);
    return copies <= most_parts && elements <= most_parts;  // also false for NaN
}

}  // namespace

void read_scene_bytes(FileBytes bytes) {
    const auto file = folder().write("scene.json", {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    try {
        if (!affordable(read_scene_file(file))) return;
        const SceneOverrides alone{.threads = 1, .backend = Backend::serial};
        Scene scene = load_scene(file, alone);
        World& world = scene.world;
        const Real step = world.settings().step_size.value_or(world.stable_step());
        expect_valid(step > 0, "a stable step that is none");
        world.advance(std::min(step, 1.0));
        for (const BodyHandle body : world.bodies())
            for (const Vec3& x : world.positions(body)) expect_valid(x.allFinite(), "a position that is not finite");
    } catch (const SceneError&) {
    }
}

}  // namespace skerry::test
