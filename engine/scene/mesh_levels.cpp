#include "engine/scene/mesh_levels.h"

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <optional>

namespace skerry {

namespace {

/// Number of times that the edge length of a mesh can be doubled, while its numbers of cells stay whole. Meshes without
/// numbers of cells (files and filled surfaces) have only the general limit.
int possible_coarsenings(const MeshEntry& mesh) {
    const auto of_cells = [](int cells) { return std::countr_zero(static_cast<unsigned>(cells)); };
    if (mesh.box) {
        const std::array<int, 3>& cells = mesh.box->cells;
        return std::min({of_cells(cells[0]), of_cells(cells[1]), of_cells(cells[2])});
    }
    if (mesh.table) return of_cells(mesh.table->cells_per_leg);
    // The number of elements across a round shape is even: an odd number is rounded up. It must still be even after the
    // last halving, so one halving less is possible.
    const auto of_round = [&](int resolution) { return of_cells(resolution + resolution % 2) - 1; };
    if (mesh.ball) return of_round(mesh.ball->resolution);
    if (mesh.cylinder) return of_round(mesh.cylinder->resolution);
    if (mesh.lathe) return of_round(mesh.lathe->resolution);
    if (mesh.skittle) return of_round(mesh.skittle->resolution);
    return most_refinements;
}

/// Key and value of the numbers of cells of a mesh, for messages. Must not be called for surfaces and files, which have
/// no numbers of cells.
std::string numbers_of(const MeshEntry& mesh) {
    if (mesh.box) {
        const std::array<int, 3>& cells = mesh.box->cells;
        return "cells [" + std::to_string(cells[0]) + ", " + std::to_string(cells[1]) + ", " +
               std::to_string(cells[2]) + "]";
    }
    if (mesh.table) return "cells_per_leg " + std::to_string(mesh.table->cells_per_leg);
    const int resolution = mesh.ball       ? mesh.ball->resolution
                           : mesh.cylinder ? mesh.cylinder->resolution
                           : mesh.lathe    ? mesh.lathe->resolution
                           : mesh.skittle  ? mesh.skittle->resolution
                                           : 0;
    return "resolution " + std::to_string(resolution);
}

/// Finds the entries of a scene that name nodes, sets or other parts of the mesh of a body.
class NamedParts {
public:
    NamedParts(const SceneFile& scene, std::size_t number) : scene_(scene), body_(scene.bodies[number]) {
        name_ = body_.name.empty() ? "body_" + std::to_string(number) : body_.name;
    }

    /// Place in the scene of the first entry that lists nodes of the mesh by number; empty if there is none.
    std::optional<Place> first_nodes() { return first(true); }
    /// Place in the scene of the first entry that uses node numbers, a set, a label or an array of the mesh file.
    std::optional<Place> first_of_file() { return first(false); }

private:
    std::optional<Place> first(bool only_nodes) {
        only_nodes_ = only_nodes;
        found_.reset();
        for (const auto& [name, set] : body_.sets.items) {
            add(!set.nodes.empty(), set.place.key("nodes"));
            for (const std::string& other : set.set.items) add_set(other, set.place.key("set"));
            add(!only_nodes && set.label, set.place.key("label"));
        }
        for (const auto& [part, material] : body_.materials.items)
            add_set(part, body_.place.key("materials").key(part));
        for (const PinEntry& pin : body_.pin.items) add_part(pin);
        for (const SurfaceEntry& surface : body_.surfaces) add_part(surface);
        for (const TieEntry& tie : scene_.ties) add_part_of(tie.body, tie);
        for (const CavityEntry& cavity : scene_.cavities) add_part_of(cavity.body, cavity);
        for (const LoadEntry& load : scene_.loads)
            if (load.body) add_part_of(*load.body, load);
        for (const FibreEntry& fibres : scene_.fibres) {
            if (!is_name(fibres.body)) continue;
            if (fibres.set) add_set(*fibres.set, fibres.place.key("set"));
            add(!only_nodes && fibres.direction_array, fibres.place.key("direction_array"));
        }
        for (const ProbeEntry& probe : scene_.probes)
            if (probe.body && probe.set && is_name(*probe.body)) add_set(*probe.set, probe.place.key("set"));
        return found_;
    }

    /// True for the name of the body. If the body has copies: true for the names of the copies, which end in a number.
    bool is_name(const std::string& name) const {
        if (!body_.repeat && body_.positions.empty()) return name == name_;
        return name.starts_with(name_ + "_") &&
               name.find_first_not_of("0123456789", name_.size() + 1) == std::string::npos;
    }
    void add(bool uses, const Place& place) {
        if (uses && !found_) found_ = place;
    }
    void add_set(const std::string& name, const Place& place) {
        add(!only_nodes_ && std::ranges::find(body_.sets.items, name, [](const auto& item) { return item.first; }) ==
                                body_.sets.items.end(),
            place);
    }
    void add_part(const PartEntry& part) {
        add(!part.nodes.empty(), part.place.key("nodes"));
        if (part.set) add_set(*part.set, part.place.key("set"));
    }
    void add_part_of(const std::string& body, const PartEntry& part) {
        if (is_name(body)) add_part(part);
    }

    const SceneFile& scene_;
    const BodyEntry& body_;
    std::string name_;
    bool only_nodes_ = false;
    std::optional<Place> found_;
};

/// Reason why the key `refine` of a mesh cannot have this value; empty if it can. `parts`: finds the entries that name
/// parts of the body's mesh; nullptr for a collider. `rigid`: true for rigid bodies and colliders.
std::string reason_against(const MeshEntry& mesh, int refine, bool rigid, NamedParts* parts) {
    if (std::abs(refine) > most_refinements)
        return "values are limited to " + std::to_string(most_refinements) + " refinements";
    if (const int most = possible_coarsenings(mesh); refine < -most)
        return numbers_of(mesh) + " cannot be halved " + (most == 0 ? "" : std::to_string(-refine) + " times ") +
               "without remainder";
    if (rigid && mesh.file && refine < 0) return "only deformable bodies get coarser meshes in place of a file";
    const bool divides = (mesh.file || mesh.surface || mesh.table) && refine > 0;
    if (refine == 0 || divides || parts == nullptr) return {};
    if (const std::optional<Place> use = parts->first_nodes())
        return use->path() + " names nodes by number, and the mesh would have other nodes";
    if (mesh.file)
        if (const std::optional<Place> use = parts->first_of_file())
            return use->path() + " names a part of the mesh file, which a coarser mesh does not have";
    return {};
}

bool is_curved(const MeshEntry& mesh) {
    return mesh.ball || mesh.cylinder || mesh.lathe || mesh.skittle;
}

/// Calls use(mesh, rigid, parts) for the mesh of each body and each mesh collider.
void for_each_mesh(const SceneFile& scene, auto use) {
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
        const BodyEntry& body = scene.bodies[b];
        NamedParts parts(scene, b);
        if (body.mesh) use(*body.mesh, body.dynamics == BodyDynamics::rigid, &parts);
    }
    for (const ColliderEntry& collider : scene.colliders)
        if (collider.shape.mesh) use(*collider.shape.mesh, true, static_cast<NamedParts*>(nullptr));
}

}  // namespace

void require_levels(const SceneFile& scene) {
    for_each_mesh(scene, [](const MeshEntry& mesh, bool rigid, NamedParts* parts) {
        const std::string reason = reason_against(mesh, mesh.refine, rigid, parts);
        if (!reason.empty())
            mesh.place.key("refine").refuse(std::to_string(mesh.refine), "a refinement that this mesh allows", reason);
    });
}

SceneLevels levels_of(const SceneFile& scene, const std::filesystem::path& file) {
    SceneLevels levels{.coarsest = -2 * most_refinements, .finest = 2 * most_refinements};
    for_each_mesh(scene, [&](const MeshEntry& mesh, bool rigid, NamedParts* parts) {
        if (rigid && !is_curved(mesh)) return;
        MeshLevels own{.place = mesh.place, .refine = mesh.refine};
        if (mesh.place.file() != file) {
            own.why_not_coarser = own.why_not_finer = "it is in the included scene " + mesh.place.file().string();
        } else {
            const auto reason = [&](int level) { return reason_against(mesh, mesh.refine + level, rigid, parts); };
            while (reason(own.finest + 1).empty()) ++own.finest;
            if (mesh.file || (mesh.surface && !mesh.edge)) {
                own.why_not_coarser = "its surface is from a file, and larger triangles can change the shape";
            } else {
                while (reason(own.coarsest - 1).empty()) --own.coarsest;
                own.why_not_coarser = reason(own.coarsest - 1);
            }
            own.why_not_finer = reason(own.finest + 1);
        }
        if (own.coarsest > levels.coarsest) {
            levels.coarsest = own.coarsest;
            levels.why_not_coarser = own.place.path() + ": " + own.why_not_coarser;
        }
        if (own.finest < levels.finest) {
            levels.finest = own.finest;
            levels.why_not_finer = own.place.path() + ": " + own.why_not_finer;
        }
        levels.meshes.push_back(std::move(own));
    });
    if (levels.meshes.empty()) {
        levels.coarsest = levels.finest = 0;
        levels.why_not_coarser = levels.why_not_finer = "the scene has no mesh whose refinement changes the results";
    }
    return levels;
}

std::vector<std::string> SceneLevels::assignments(int level) const {
    std::vector<std::string> all;
    for (const MeshLevels& mesh : meshes)
        all.push_back(mesh.place.key("refine").path() + "=" + std::to_string(mesh.refine + level));
    return all;
}

std::vector<std::string> element_assignments(const SceneFile& scene, const std::filesystem::path& file,
                                             ElementKind element) {
    std::vector<std::string> all;
    for (const BodyEntry& body : scene.bodies)
        if (body.mesh && body.dynamics != BodyDynamics::rigid && body.place.file() == file)
            all.push_back(body.place.key("element").path() + "=" + std::string(name_of(element)));
    return all;
}

}  // namespace skerry
