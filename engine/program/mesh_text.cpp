#include "engine/program/mesh_text.h"

#include <array>

#include "engine/output/number_text.h"
#include "engine/program/start_text.h"

namespace skerry {

Problems problems_of(const MeshReport& r) {
    Problems problems;
    if (r.tetrahedra == 0 && r.boundary_triangles == 0) problems.push_back("the mesh has no tetrahedra");
    if (r.inverted > 0)
        problems.push_back(grouped(r.inverted) + " inverted tetrahedra (of negative volume): a run refuses the mesh");
    if (r.flat > 0) problems.push_back(grouped(r.flat) + " flat tetrahedra (without volume): a run refuses the mesh");
    if (r.components > 1 && r.tetrahedra > 0)
        problems.push_back(grouped(r.components) + " parts of the mesh are not connected to each other");
    if (r.slivers > 0)
        problems.push_back(grouped(r.slivers) + " of " + grouped(r.tetrahedra) +
                           (r.slivers == 1 ? " tetrahedra is a sliver" : " tetrahedra are slivers") +
                           ", the worst of quality " + short_text(r.min_quality) +
                           " (1: regular tetrahedron), which shortens the stable step");
    if (!r.closed_manifold)
        problems.push_back("the boundary is not a closed manifold (" + r.boundary_fault + "): contacts may fail there");
    return problems;
}

Json mesh_json(const MeshReport& r) {
    Json labels = Json::object();
    for (const auto& [label, tetrahedra] : r.labels) labels[std::to_string(label)] = tetrahedra;
    Json sets = Json::object();
    for (const auto& [name, count] : r.sets)
        sets[name] = object_of({{"nodes", count[0]}, {"faces", count[1]}, {"tetrahedra", count[2]}});
    return object_of({{"nodes", r.nodes},
                      {"tetrahedra", r.tetrahedra},
                      {"boundary_triangles", r.boundary_triangles},
                      {"components", r.components},
                      {"lower", vector_json(r.lower)},
                      {"upper", vector_json(r.upper)},
                      {"volume", r.volume},
                      {"edge", object_of({{"mean", r.mean_edge}, {"min", r.min_edge}, {"max", r.max_edge}})},
                      {"min_altitude", r.min_altitude},
                      {"quality", object_of({{"min", r.min_quality}, {"mean", r.mean_quality}})},
                      {"inverted", r.inverted},
                      {"flat", r.flat},
                      {"slivers", r.slivers},
                      {"closed_manifold", r.closed_manifold},
                      {"labels", labels},
                      {"sets", sets}});
}

std::string labels_text(const MeshReport& report) {
    constexpr std::size_t most = 20;
    std::string text;
    std::size_t listed = 0;
    for (const auto& [label, tetrahedra] : report.labels) {
        if (listed == most) return text + ", ... (" + grouped(report.labels.size()) + " labels)";
        text +=
            (listed++ > 0 ? ", label " : "label ") + std::to_string(label) + ": " + grouped(tetrahedra) + " tetrahedra";
    }
    return text;
}

std::string set_text(const std::string& name, const std::array<std::size_t, 3>& count) {
    constexpr std::array<const char*, 3> one{"node", "face", "tetrahedron"}, more{"nodes", "faces", "tetrahedra"};
    std::string text;
    for (std::size_t kind = 0; kind < 3; ++kind)
        if (count[kind] > 0)
            text +=
                (text.empty() ? "" : ", ") + grouped(count[kind]) + " " + (count[kind] == 1 ? one[kind] : more[kind]);
    return in_quotes(name) + ": " + text;
}

std::string mesh_of_body_text(const ScenePlan& plan, std::size_t body) {
    const BodyPlan& of = plan.bodies[body];
    const std::filesystem::path& file = plan.mesh_files[of.mesh];
    return "body \"" + of.settings.name + "\"" + (file.empty() ? "" : " (mesh " + file.string() + ")");
}

}  // namespace skerry
