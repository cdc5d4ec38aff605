// Finds the nodes, faces and tetrahedra of the sets of bodies, and of the parts of bodies that entries of a scene name.
#include <algorithm>
#include <set>
#include <span>
#include <utility>

#include "engine/mesh/labels.h"
#include "engine/mesh/sets.h"
#include "engine/scene/scene_file.h"
#include "engine/scene/scene_plan.h"
#include "systems/collision/build_surface.h"

namespace skerry {

namespace {

using NamedSets = std::map<std::string, MeshSet>;

const char* const mesh_frame =
    "coordinates are those of the mesh, before rotation and position of the body are applied";

/// Returns the index in mesh.nodes of a node that the scene names by its number in the mesh file.
Index node_of_file(const PlannedMesh& mesh, int number, const Place& place) {
    // Subdivisions add their nodes at the end, and the file has no numbers for these.
    const std::size_t count = mesh.subdivisions.empty() ? mesh.nodes.size() : mesh.subdivisions.front().node_count;
    if (mesh.file_number.empty()) {
        if (static_cast<std::size_t>(number) >= count)
            place.refuse("node " + std::to_string(number), "a node number below " + std::to_string(count));
        return number;
    }
    const std::span<const Index> numbers = std::span(mesh.file_number).first(count);
    const auto found = std::ranges::lower_bound(numbers, number);
    if (found == numbers.end() || *found != number)
        place.refuse("node " + std::to_string(number) + ", which no tetrahedron of the mesh file uses",
                     "the number of a node of a tetrahedron, from " + std::to_string(numbers.front()) + " to " +
                         std::to_string(numbers.back()),
                     "count all nodes of the file from 0, in their order in the file");
    return static_cast<Index>(found - numbers.begin());
}

std::vector<Index> nodes_listed(const PlannedMesh& mesh, const std::vector<int>& numbers, const Place& place) {
    if (numbers.empty()) place.refuse("an empty list", "at least one node number");
    std::vector<Index> nodes;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        const Place item = place.item(i);
        const Index node = node_of_file(mesh, numbers[i], item);
        if (std::ranges::find(nodes, node) != nodes.end())
            item.refuse("node " + std::to_string(numbers[i]) + " for the second time", "every node at most once",
                        "delete the repeated number");
        nodes.push_back(node);
    }
    for (const mesh::Subdivision& subdivision : mesh.subdivisions) mesh::add_midpoints(subdivision, nodes);
    return nodes;
}

bool is_inside(const RestBox& box, const Vec3& x) {
    return (x.array() >= box.lower.array()).all() && (x.array() <= box.upper.array()).all();
}

std::vector<std::array<Index, 3>> surface_faces(const Mesh& mesh) {
    std::vector<std::array<Index, 3>> surface = mesh.triangles;
    for (const BoundaryTriangle& triangle : boundary_triangles(mesh.tetrahedra)) surface.push_back(triangle.node);
    return surface;
}

/// Returns the parts of a mesh that the keys "set" and "label" of an entry select; plan_set() applies the other
/// conditions.
/// - Sets only: the union of the named sets.
/// - With a label: the tetrahedra with this label within the union, or within the whole mesh if no sets are named.
/// - Neither: all nodes.
MeshSet first_set(const SetEntry& entry, const Mesh& mesh, const NamedSets& known) {
    MeshSet set;
    for (const std::string& name : entry.set.items) {
        const MeshSet& other = find_set(name, mesh, known, entry.place.key("set"));
        set.nodes.insert(set.nodes.end(), other.nodes.begin(), other.nodes.end());
        set.faces.insert(set.faces.end(), other.faces.begin(), other.faces.end());
        set.tetrahedra.insert(set.tetrahedra.end(), other.tetrahedra.begin(), other.tetrahedra.end());
    }
    if (entry.label) {
        if (std::ranges::find(mesh.label, *entry.label) == mesh.label.end())
            entry.place.key("label").refuse("label " + std::to_string(*entry.label), mesh::expected_label(mesh));
        if (set.empty())
            for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) set.tetrahedra.push_back(static_cast<Index>(t));
        set = {.nodes = {}, .faces = {}, .tetrahedra = mesh::tetrahedra_of(set, mesh.tetrahedra)};
        std::erase_if(set.tetrahedra, [&](Index t) { return mesh.label[static_cast<std::size_t>(t)] != *entry.label; });
    } else if (entry.set.items.empty()) {
        for (std::size_t n = 0; n < mesh.nodes.size(); ++n) set.nodes.push_back(static_cast<Index>(n));
    }
    return set;
}

MeshSet plan_set(const SetEntry& entry, const PlannedMesh& mesh, const NamedSets& known) {
    MeshSet set = first_set(entry, mesh, known);
    if (entry.surface) {
        const std::vector<std::array<Index, 3>> surface = surface_faces(mesh);
        set = {.nodes = {}, .faces = mesh::faces_of(set, mesh.tetrahedra, surface), .tetrahedra = {}};
        std::set<std::array<Index, 3>> outside;
        for (const std::array<Index, 3>& face : surface) outside.insert(mesh::sorted_face(face));
        std::erase_if(set.faces, [&](const auto& face) { return !outside.contains(mesh::sorted_face(face)); });
    }
    std::vector<Index> wanted;
    if (!entry.nodes.empty()) wanted = nodes_listed(mesh, entry.nodes, entry.place.key("nodes"));
    const auto meets = [&](Index n) {
        const Vec3& x = mesh.nodes[static_cast<std::size_t>(n)];
        return (!entry.box || is_inside(*entry.box, x)) &&
               (!entry.sphere || (x - entry.sphere->center).norm() <= entry.sphere->radius) &&
               (!entry.half_space || (x - entry.half_space->point).dot(entry.half_space->normal) >= 0) &&
               (wanted.empty() || std::ranges::find(wanted, n) != wanted.end());
    };
    std::erase_if(set.nodes, [&](Index n) { return !meets(n); });
    std::erase_if(set.faces, [&](const auto& face) { return !std::ranges::all_of(face, meets); });
    std::erase_if(set.tetrahedra,
                  [&](Index t) { return !std::ranges::all_of(mesh.tetrahedra[static_cast<std::size_t>(t)], meets); });
    mesh::tidy(set);
    if (set.empty())
        entry.place.refuse("conditions that no part of the mesh meets", "a set with at least one node", mesh_frame);
    return set;
}

std::vector<std::string> names_of_all(const Mesh& mesh, const NamedSets& sets) {
    std::vector<std::string> names = mesh::names_of(sets);
    for (const std::string& of_mesh : mesh::names_of(mesh.sets)) names.push_back(of_mesh);
    return names;
}

const MeshSet& set_of_part(const PartEntry& part, const Mesh& mesh, const NamedSets& sets) {
    return find_set(*part.set, mesh, sets, part.place.key("set"));
}

}  // namespace

const MeshSet& find_set(const std::string& name, const Mesh& mesh, const NamedSets& sets, const Place& place) {
    if (const auto found = sets.find(name); found != sets.end()) return found->second;
    if (const auto found = mesh.sets.find(name); found != mesh.sets.end()) return found->second;
    place.refuse(in_quotes(name), expected_set(mesh, sets), nearest_hint(name, names_of_all(mesh, sets)));
}

std::string expected_set(const Mesh& mesh, const NamedSets& sets) {
    return mesh::expected_set(names_of_all(mesh, sets));
}

NamedSets plan_sets(const Named<SetEntry>& entries, const PlannedMesh& mesh, const Place& place) {
    NamedSets sets;
    for (const auto& [name, entry] : entries.items) {
        if (mesh.sets.contains(name))
            place.key(name).refuse(in_quotes(name) + ", which is already the name of a set of the mesh file",
                                   "a different name");
        sets.emplace(name, plan_set(entry, mesh, sets));
    }
    return sets;
}

std::vector<Index> nodes_of(const PartEntry& part, const PlannedMesh& mesh, const NamedSets& sets) {
    if (part.set) return mesh::nodes_of(set_of_part(part, mesh, sets), mesh.tetrahedra);
    if (!part.box) return nodes_listed(mesh, part.nodes, part.place.key("nodes"));
    std::vector<Index> inside;
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
        if (is_inside(*part.box, mesh.nodes[n])) inside.push_back(static_cast<Index>(n));
    if (inside.empty())
        part.place.key("box").refuse("a box that contains no node of the mesh", "a box around at least one node",
                                     mesh_frame);
    return inside;
}

std::vector<Index> nodes_of(const PartEntry& part, const BodyPlan& body, const ScenePlan& plan) {
    return nodes_of(part, plan.meshes[body.mesh], body.sets);
}

std::vector<std::array<Index, 3>> faces_of(const MeshSet& set, const Mesh& mesh) {
    return mesh::faces_of(set, mesh.tetrahedra, surface_faces(mesh));
}

std::vector<std::array<Index, 3>> faces_of(const PartEntry& part, const BodyPlan& body, const ScenePlan& plan) {
    const Mesh& mesh = plan.meshes[body.mesh];
    MeshSet set;
    if (part.set)
        set = set_of_part(part, mesh, body.sets);
    else
        set.nodes = nodes_of(part, body, plan);
    mesh::tidy(set);
    std::vector<std::array<Index, 3>> faces = faces_of(set, mesh);
    if (faces.empty())
        part.place.key(part.set   ? "set"
                       : part.box ? "box"
                                  : "nodes")
            .refuse("a part that contains no face of the surface", "a part that contains all nodes of a face");
    return faces;
}

}  // namespace skerry
