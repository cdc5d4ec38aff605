// Assignment of surface features (triangles, edges and vertices) to surface sets (components/surface_rules.h).
#include <algorithm>

#include "engine/mesh/sets.h"
#include "engine/world/state/model.h"

namespace skerry {

namespace {

/// Writes the row of one surface set into SetOfFeature, for all features that belong to the set.
class SetIndex {
public:
    SetIndex(const Model& model, std::size_t set, SetOfFeature& of)
        : model_(model),
          set_(static_cast<Index>(set)),
          of_(of),
          body_(static_cast<std::size_t>(model.surface_sets.body[set])) {}

    void write() {
        std::vector<std::array<Index, 3>> faces;
        listed_.assign(static_cast<std::size_t>(model_.bodies.nodes[body_].size()), false);
        in_set_ = listed_;
        for (const std::array<Index, 3>& member : model_.surface_sets.members_of(static_cast<std::size_t>(set_))) {
            if (member[0] == member[1])
                listed_[static_cast<std::size_t>(member[0])] = in_set_[static_cast<std::size_t>(member[0])] = true;
            else
                faces.push_back(member);
        }
        for (const Index t : model_.triangles_of(body_, faces))
            if (t != no_index) add_triangle(t);
        const BodyTable& bodies = model_.bodies;
        for (Index t = bodies.triangles[body_].begin; t < bodies.triangles[body_].end; ++t)
            if (are_listed(model_.surface.triangles.node[static_cast<std::size_t>(t)])) add_triangle(t);
        for (Index e = bodies.edges[body_].begin; e < bodies.edges[body_].end; ++e)
            if (are_listed(model_.surface.edges.node[static_cast<std::size_t>(e)]))
                of_.edge[static_cast<std::size_t>(e)] = set_;
        for (Index v = bodies.vertices[body_].begin; v < bodies.vertices[body_].end; ++v)
            if (in_set_[local(model_.surface.vertices.node[static_cast<std::size_t>(v)])])
                of_.vertex[static_cast<std::size_t>(v)] = set_;
    }

private:
    std::size_t local(Index node) const { return static_cast<std::size_t>(node - model_.bodies.nodes[body_].begin); }
    bool are_listed(std::span<const Index> nodes) const {
        return std::ranges::all_of(nodes, [&](Index node) { return listed_[local(node)]; });
    }
    void add_triangle(Index triangle) {
        const auto t = static_cast<std::size_t>(triangle);
        of_.triangle[t] = set_;
        for (const Index edge : model_.surface.triangles.edge[t]) of_.edge[static_cast<std::size_t>(edge)] = set_;
        for (const Index node : model_.surface.triangles.node[t]) in_set_[local(node)] = true;
    }

    const Model& model_;
    Index set_;
    SetOfFeature& of_;
    std::size_t body_;
    // Entries by node number within the body. `listed_`: the set lists the node itself. `in_set_`: the set lists the
    // node, or it is a corner of a triangle in the set.
    std::vector<bool> listed_, in_set_;
};

}  // namespace

std::vector<Index> Model::triangles_of(std::size_t body, std::span<const std::array<Index, 3>> faces) const {
    struct Entry {
        std::array<Index, 3> node;
        Index row;
    };
    std::vector<Entry> entries;
    const Range triangles = bodies.triangles[body];
    if (!faces.empty())
        for (Index t = triangles.begin; t < triangles.end; ++t) {
            std::array<Index, 3> node = surface.triangles.node[static_cast<std::size_t>(t)];
            for (Index& n : node) n -= bodies.nodes[body].begin;
            entries.push_back({mesh::sorted_face(node), t});
        }
    std::ranges::sort(entries, {}, &Entry::node);
    std::vector<Index> found;
    for (const std::array<Index, 3>& face : faces) {
        const auto entry = std::ranges::lower_bound(entries, mesh::sorted_face(face), {}, &Entry::node);
        found.push_back(entry != entries.end() && entry->node == mesh::sorted_face(face) ? entry->row : no_index);
    }
    return found;
}

void Model::index_surface_sets() {
    const bool any = surface_sets.size() > 0;
    set_of_feature.triangle.assign(any ? surface.triangles.node.size() : 0, no_index);
    set_of_feature.edge.assign(any ? surface.edges.node.size() : 0, no_index);
    set_of_feature.vertex.assign(any ? surface.vertices.node.size() : 0, no_index);
    for (std::size_t set = 0; set < surface_sets.size(); ++set) SetIndex(*this, set, set_of_feature).write();
}

}  // namespace skerry
