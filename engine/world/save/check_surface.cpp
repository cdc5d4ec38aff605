#include <cmath>
#include <string>

#include "engine/world/save/checks.h"

namespace skerry {

namespace {

bool is_coefficient(Real value) {
    return std::isfinite(value) || value == -1;
}

void expect_surfaces(const SavedFile& file, const std::string& path, std::span<const SurfaceProperties> surfaces) {
    for (std::size_t row = 0; row < surfaces.size(); ++row) {
        const SurfaceProperties& of_row = surfaces[row];
        if (!is_coefficient(of_row.static_friction) || !is_coefficient(of_row.dynamic_friction) ||
            !is_coefficient(of_row.restitution) || of_row.dynamic_friction > of_row.static_friction)
            file.complain(path, at_row("invalid friction or restitution", row),
                          "finite numbers, with static friction >= dynamic friction");
    }
}

void check_sets(const SavedFile& file, const Model& model) {
    const SurfaceSetTable& sets = model.surface_sets;
    expect_partition(file, "surface_sets/members", sets.members, sets.member.size());
    expect_surfaces(file, "surface_sets/surface", sets.surface);
    expect_between(file, "surface_sets/across", sets.across, 0.0, infinity);
    for (std::size_t set = 0; set < sets.size(); ++set) {
        if (sets.body[set] == no_index)
            file.complain("surface_sets/body", at_row(std::string("-1"), set), "the index of a body");
        const auto body = static_cast<std::size_t>(sets.body[set]);
        if (model.bodies.core_nodes[body] > 0 || model.bodies.kind[body] != BodyKind::deformable)
            file.complain("surface_sets/body", at_row("a body without faces", set), "a body with faces");
        if (!sets.direction[set].allFinite() || !(sets.across[set] > 0))
            file.complain("surface_sets/direction", at_row("a direction or ratio that is not valid", set),
                          "a finite direction and a ratio of coefficients > 0");
        for (const std::array<Index, 3>& member : sets.members_of(set))
            for (const Index node : member)
                if (node < 0 || node >= model.bodies.nodes[body].size())
                    file.complain("surface_sets/member", at_row("node " + std::to_string(node), set),
                                  "a node of the body of the set");
    }
}

}  // namespace

void check_surface_rules(const SavedFile& file, const Model& model) {
    const MaterialPairTable& pairs = model.material_pairs;
    const std::size_t materials = model.materials.slot.size();
    expect_rows_of(file, "colliders/material", model.colliders.material, materials, true);
    expect_size(file, "material_pairs/second", pairs.second.size(), pairs.size());
    expect_size(file, "material_pairs/surface", pairs.surface.size(), pairs.size());
    expect_rows_of(file, "material_pairs/first", pairs.first, materials);
    expect_rows_of(file, "material_pairs/second", pairs.second, materials);
    expect_surfaces(file, "material_pairs/surface", pairs.surface);
    for (std::size_t row = 0; row < pairs.size(); ++row)
        if (pairs.first[row] > pairs.second[row] || pairs.place_of(pairs.first[row], pairs.second[row]) != row)
            file.complain("material_pairs/first", at_row(std::to_string(pairs.first[row]), row),
                          "pairs in ascending order, each with the lower material first");
    check_sets(file, model);
}

}  // namespace skerry
