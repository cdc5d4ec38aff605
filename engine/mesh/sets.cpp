#include "engine/mesh/sets.h"

#include <algorithm>
#include <cstdint>
#include <set>
#include <utility>

#include "engine/base/complaint.h"
#include "systems/collision/build_surface.h"

namespace skerry::mesh {
namespace {

void sort_unique(std::vector<Index>& numbers) {
    std::ranges::sort(numbers);
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

/// True if `in` contains all of the nodes. `in` must be ascending, for binary search.
template <std::size_t N>
bool has_all(const std::vector<Index>& in, const std::array<Index, N>& nodes) {
    return std::ranges::all_of(nodes, [&](Index n) { return std::ranges::binary_search(in, n); });
}

[[noreturn]] void refuse_set(const std::string& object, const std::string& name, const std::string& found,
                             const std::string& expected) {
    refuse_in(object, {}, "sets[\"" + name + "\"]", found, expected);
}

}  // namespace

void tidy(MeshSet& set) {
    sort_unique(set.nodes);
    sort_unique(set.tetrahedra);
    std::set<std::array<Index, 3>> known;
    std::erase_if(set.faces, [&](const std::array<Index, 3>& face) { return !known.insert(sorted_face(face)).second; });
}

void require_set(const std::string& object, const std::string& name, const MeshSet& set, std::size_t node_count,
                 std::span<const std::array<Index, 4>> tetrahedra, std::span<const std::array<Index, 3>> surface) {
    const auto require = [&](Index number, std::size_t count, const char* kind) {
        if (number < 0 || number >= static_cast<Index>(count))
            refuse_set(object, name, std::string(kind) + " " + std::to_string(number),
                       "numbers from 0 to " + std::to_string(static_cast<Index>(count) - 1));
    };
    for (const Index n : set.nodes) require(n, node_count, "node");
    for (const Index t : set.tetrahedra) require(t, tetrahedra.size(), "tetrahedron");
    if (set.faces.empty()) return;
    std::vector<std::array<Index, 3>> faces;
    for (const TetrahedronFace& face : sorted_faces(tetrahedra)) faces.push_back(face.node);
    for (const std::array<Index, 3>& triangle : surface) faces.push_back(sorted_face(triangle));
    std::ranges::sort(faces);
    for (const std::array<Index, 3>& face : set.faces)
        if (!std::ranges::binary_search(faces, sorted_face(face)))
            refuse_set(object, name,
                       "a face with the nodes " + std::to_string(face[0]) + ", " + std::to_string(face[1]) + " and " +
                           std::to_string(face[2]),
                       "the nodes of a face of a tetrahedron or of the surface");
}

std::size_t match_faces(std::span<const std::array<Index, 4>> tetrahedra, std::map<std::string, MeshSet>& sets) {
    if (std::ranges::all_of(sets, [](const auto& item) { return item.second.faces.empty(); })) return 0;
    const std::vector<TetrahedronFace> all = sorted_faces(tetrahedra);
    std::vector<std::pair<std::array<Index, 3>, std::array<Index, 3>>> outer;  // sorted nodes, nodes oriented outward
    for (const BoundaryTriangle& t : boundary_triangles(tetrahedra)) outer.emplace_back(sorted_face(t.node), t.node);
    std::ranges::sort(outer);
    std::size_t dropped = 0;
    for (auto& [name, set] : sets) {
        dropped += std::erase_if(set.faces, [&](const std::array<Index, 3>& face) {
            return !std::ranges::binary_search(all, sorted_face(face), {}, &TetrahedronFace::node);
        });
        for (std::array<Index, 3>& face : set.faces) {
            const auto found =
                std::ranges::lower_bound(outer, sorted_face(face), {}, [](const auto& o) { return o.first; });
            if (found != outer.end() && found->first == sorted_face(face)) face = found->second;
        }
    }
    return dropped;
}

std::vector<std::string> names_of(const std::map<std::string, MeshSet>& sets) {
    std::vector<std::string> names;
    for (const auto& [name, set] : sets) names.push_back(name);
    return names;
}

std::string expected_set(const std::vector<std::string>& names) {
    if (names.empty()) return "no set, because there are none";
    std::string text = "one of the sets ";
    for (const std::string& name : names) text += (&name == names.data() ? "\"" : ", \"") + name + "\"";
    return text;
}

std::vector<Index> nodes_of(const MeshSet& set, std::span<const std::array<Index, 4>> tetrahedra) {
    std::vector<Index> nodes = set.nodes;
    for (const std::array<Index, 3>& face : set.faces) nodes.insert(nodes.end(), face.begin(), face.end());
    for (const Index t : set.tetrahedra) {
        const std::array<Index, 4>& corners = tetrahedra[static_cast<std::size_t>(t)];
        nodes.insert(nodes.end(), corners.begin(), corners.end());
    }
    sort_unique(nodes);
    return nodes;
}

std::vector<std::array<Index, 3>> faces_of(const MeshSet& set, std::span<const std::array<Index, 4>> tetrahedra,
                                           std::span<const std::array<Index, 3>> surface) {
    std::vector<std::array<Index, 3>> faces = set.faces;
    std::set<std::array<Index, 3>> listed, of_tetrahedra;
    for (const std::array<Index, 3>& face : set.faces) listed.insert(sorted_face(face));
    for (const Index t : set.tetrahedra) {
        const auto& [a, b, c, d] = tetrahedra[static_cast<std::size_t>(t)];
        for (const std::array<Index, 3>& face :
             {std::array{b, c, d}, std::array{a, c, d}, std::array{a, b, d}, std::array{a, b, c}})
            of_tetrahedra.insert(sorted_face(face));
    }
    for (const std::array<Index, 3>& face : surface) {
        const std::array<Index, 3> nodes = sorted_face(face);
        if (!listed.contains(nodes) && (of_tetrahedra.contains(nodes) || has_all(set.nodes, face)))
            faces.push_back(face);
    }
    return faces;
}

std::vector<Index> tetrahedra_of(const MeshSet& set, std::span<const std::array<Index, 4>> tetrahedra) {
    if (!set.tetrahedra.empty()) return set.tetrahedra;
    const std::vector<Index> nodes = nodes_of(set, tetrahedra);
    std::vector<Index> inside;
    for (std::size_t t = 0; t < tetrahedra.size(); ++t)
        if (has_all(nodes, tetrahedra[t])) inside.push_back(static_cast<Index>(t));
    return inside;
}

}  // namespace skerry::mesh
