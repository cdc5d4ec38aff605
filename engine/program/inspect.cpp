#include <algorithm>
#include <iostream>
#include <map>

#include "engine/program/commands.h"
#include "engine/program/number_text.h"
#include "engine/program/progress.h"
#include "engine/scene/scene_plan.h"

namespace skerry {

namespace {

using Problems = std::vector<std::string>;

constexpr Real poor_quality = 0.1;        // below it a tetrahedron is a sliver that costs steps and accuracy
constexpr Real expensive_step_ratio = 4;  // a body that bounds the step this much below the next one is worth a word
constexpr int timed_steps = 20;

Json vector_json(const Vec3& v) {
    return {v.x(), v.y(), v.z()};
}

Problems problems_of(const MeshReport& r) {
    Problems problems;
    if (r.tetrahedra == 0) problems.push_back("no tetrahedron");
    if (r.inverted > 0) problems.push_back(grouped(r.inverted) + " inverted tetrahedra: a world refuses them");
    if (r.flat > 0) problems.push_back(grouped(r.flat) + " flat tetrahedra: a world refuses them");
    if (r.components > 1) problems.push_back(grouped(r.components) + " parts that are not connected");
    if (r.tetrahedra > 0 && r.min_quality < poor_quality)
        problems.push_back("a sliver of quality " + short_number(r.min_quality) + ", which makes steps short");
    if (!r.closed_manifold) problems.push_back("the boundary is not a closed manifold");
    return problems;
}

Json mesh_json(const MeshReport& r) {
    Json labels = Json::object();
    for (const auto& [label, tetrahedra] : r.labels) labels[std::to_string(label)] = tetrahedra;
    return {{"nodes", r.nodes},
            {"tetrahedra", r.tetrahedra},
            {"boundary_triangles", r.boundary_triangles},
            {"components", r.components},
            {"lower", vector_json(r.lower)},
            {"upper", vector_json(r.upper)},
            {"volume", r.volume},
            {"edge", {{"mean", r.mean_edge}, {"min", r.min_edge}, {"max", r.max_edge}}},
            {"min_altitude", r.min_altitude},
            {"quality", {{"min", r.min_quality}, {"mean", r.mean_quality}}},
            {"inverted", r.inverted},
            {"flat", r.flat},
            {"closed_manifold", r.closed_manifold},
            {"labels", labels}};
}

void print_problems(const Problems& problems) {
    if (problems.empty()) std::cout << "  problems      none found\n";
    for (const std::string& problem : problems) std::cout << "  problem       " << problem << "\n";
}

/// "1: 300, 2: 20 tetrahedra"; of many the first.
std::string labels_text(const MeshReport& report) {
    constexpr std::size_t most = 20;
    std::string text;
    std::size_t listed = 0;
    for (const auto& [label, tetrahedra] : report.labels) {
        if (listed == most) return text + ", ... (" + grouped(report.labels.size()) + " labels)";
        text += (listed++ > 0 ? ", " : "") + std::to_string(label) + ": " + grouped(tetrahedra);
    }
    return text + " tetrahedra";
}

int inspect_mesh(const InspectOptions& options) {
    const MeshReport report = inspect(mesh::read(options.file.string()));
    const Problems problems = problems_of(report);
    if (options.json) {
        Json json = {{"schema", "skerry.mesh/1"}, {"file", options.file.string()}};
        json.update(mesh_json(report));
        json["problems"] = problems;
        std::cout << json.dump(1) << std::endl;
        return exit_ok;
    }
    const Vec3 size = report.upper - report.lower;
    std::cout << options.file.string() << ": " << grouped(report.tetrahedra) << " tetrahedra, " << grouped(report.nodes)
              << " nodes, " << grouped(report.boundary_triangles) << " boundary triangles\n"
              << "  size          " << short_number(size.x()) << " x " << short_number(size.y()) << " x "
              << short_number(size.z()) << " m, volume " << short_number(report.volume) << " m^3\n"
              << "  edges         mean " << with_unit(report.mean_edge, "m") << ", " << with_unit(report.min_edge, "m")
              << " to " << with_unit(report.max_edge, "m") << "; smallest altitude "
              << with_unit(report.min_altitude, "m") << "\n"
              << "  quality       mean " << short_number(report.mean_quality) << ", worst "
              << short_number(report.min_quality) << " (1 is regular)\n"
              << "  boundary      " << (report.closed_manifold ? "a closed manifold" : "not a closed manifold") << ", "
              << grouped(report.components) << (report.components == 1 ? " part\n" : " parts\n");
    if (!report.labels.empty()) std::cout << "  labels        " << labels_text(report) << "\n";
    print_problems(problems);
    return exit_ok;
}

/// Bodies that share mesh and materials, and so a stable step.
struct BodyKindReport {
    std::string first_name;
    std::vector<std::pair<std::string, std::size_t>> materials;  // and how many tetrahedra have each; more than 0
    std::size_t count = 0;
    MeshReport mesh;
    Real stable_step = 0;  // s
    ElementKind element{};
};

/// The body's own material first, then those of its labels.
std::vector<std::pair<std::string, std::size_t>> count_materials(const ScenePlan& plan, const BodyPlan& body,
                                                                 const MeshReport& mesh) {
    std::vector<std::pair<std::size_t, std::size_t>> count{{body.material, mesh.tetrahedra}};
    for (const auto& [label, material] : body.materials) {
        const std::size_t tetrahedra = mesh.labels.at(label);
        count.front().second -= tetrahedra;
        const auto same = std::find_if(count.begin(), count.end(),
                                       [wanted = material](const auto& known) { return known.first == wanted; });
        if (same != count.end())
            same->second += tetrahedra;
        else
            count.emplace_back(material, tetrahedra);
    }
    std::vector<std::pair<std::string, std::size_t>> named;
    for (const auto& [material, tetrahedra] : count)
        if (tetrahedra > 0) named.emplace_back(plan.materials[material].first, tetrahedra);
    return named;
}

/// Each kind of body in a world of its own: that is the step it would allow.
std::vector<BodyKindReport> body_kinds(const ScenePlan& plan) {
    std::map<std::pair<std::size_t, std::size_t>, std::size_t> row;
    std::vector<BodyKindReport> kinds;
    for (const BodyPlan& body : plan.bodies) {
        const auto [at, is_new] = row.try_emplace({body.mesh, body.material}, kinds.size());
        if (is_new) {
            Settings settings = plan.settings;
            settings.step_size.reset();
            settings.backend = Backend::serial;
            World alone(settings);
            BodySettings settings_of_body = body.settings;
            std::vector<MaterialHandle> materials;
            for (const auto& [name, material] : plan.materials) materials.push_back(alone.add_material(material));
            settings_of_body.material = materials[body.material];
            for (const auto& [label, material] : body.materials)
                settings_of_body.materials.emplace(label, materials[material]);
            const BodyHandle added = alone.add_body(plan.meshes[body.mesh], settings_of_body);
            const MeshReport mesh = inspect(plan.meshes[body.mesh]);
            kinds.push_back({body.settings.name, count_materials(plan, body, mesh), 0, mesh, alone.stable_step(),
                             alone.element(added)});
        }
        ++kinds[at->second].count;
    }
    return kinds;
}

/// "steel", or "steel 300, rubber 20".
std::string materials_text(const BodyKindReport& kind) {
    if (kind.materials.size() == 1) return kind.materials.front().first;
    std::string text;
    for (const auto& [material, tetrahedra] : kind.materials)
        text += (text.empty() ? "" : ", ") + material + " " + grouped(tetrahedra);
    return text;
}

struct SceneCost {
    double seconds_per_second = 0;  // wall time of a simulated second as the scene starts
    Real overlap = 0;               // m, at the start
    Index contacts = 0;             // at the start
    std::string failure;
};

SceneCost try_steps(World& world) {
    SceneCost cost;
    constexpr Real hardly = 1e-9;  // s: finds contacts, moves nothing that matters
    const StepReport first = world.advance(hardly);
    cost.overlap = first.max_penetration;
    cost.contacts = first.contacts;
    if (!first.ok()) cost.failure = first.message();
    const Stopwatch watch;
    const Real duration = timed_steps * world.stable_step();
    const StepReport steps = world.advance(duration);
    if (!steps.ok()) cost.failure = steps.message();
    cost.seconds_per_second = watch.seconds() / duration;
    return cost;
}

Problems problems_of(const std::vector<BodyKindReport>& kinds, const SceneCost& cost) {
    Problems problems;
    for (const BodyKindReport& kind : kinds)
        for (const std::string& problem : problems_of(kind.mesh))
            problems.push_back("body \"" + kind.first_name + "\": " + problem);
    std::vector<BodyKindReport> by_step = kinds;
    std::sort(by_step.begin(), by_step.end(),
              [](const auto& a, const auto& b) { return a.stable_step < b.stable_step; });
    if (by_step.size() > 1 && by_step[1].stable_step > expensive_step_ratio * by_step[0].stable_step)
        problems.push_back("body \"" + by_step[0].first_name + "\" makes all steps " +
                           short_number(by_step[1].stable_step / by_step[0].stable_step) +
                           " times shorter than the others need");
    if (cost.overlap > 0) problems.push_back("surfaces overlap by " + with_unit(cost.overlap, "m") + " at the start");
    if (!cost.failure.empty()) problems.push_back("the first steps fail: " + cost.failure);
    return problems;
}

int inspect_scene(const InspectOptions& options) {
    const ScenePlan plan = plan_scene(options.file);
    Scene scene = build_scene(plan);
    const std::vector<BodyKindReport> kinds = body_kinds(plan);
    const WorldReport report = scene.world.report();
    const Real stable_step = scene.world.stable_step();
    const SceneCost cost = try_steps(scene.world);
    const Problems problems = problems_of(kinds, cost);
    if (options.json) {
        Json bodies = Json::array();
        for (const BodyKindReport& kind : kinds) {
            Json materials = Json::object();
            for (const auto& [material, tetrahedra] : kind.materials) materials[material] = tetrahedra;
            bodies.push_back({{"name", kind.first_name},
                              {"count", kind.count},
                              {"materials", materials},
                              {"stable_dt", kind.stable_step},
                              {"element", name_of(kind.element)},
                              {"mesh", mesh_json(kind.mesh)}});
        }
        const Json json = {{"schema", "skerry.scene_facts/1"},
                           {"scene", scene.name},
                           {"description", scene.description},
                           {"seconds", scene.seconds},
                           {"bodies", report.bodies},
                           {"colliders", report.colliders},
                           {"nodes", report.nodes},
                           {"elements", report.elements},
                           {"stable_dt", stable_step},
                           {"stable_dt_body", report.stable_step_body},
                           {"contacts_at_start", cost.contacts},
                           {"overlap_at_start", cost.overlap},
                           {"wall_seconds_per_second", cost.seconds_per_second},
                           {"body_kinds", bodies},
                           {"problems", problems}};
        std::cout << json.dump(1) << std::endl;
        return exit_ok;
    }
    std::cout << scene.name << ": " << scene.description << "\n"
              << "  bodies        " << grouped(report.bodies) << ", " << grouped(report.nodes) << " nodes, "
              << grouped(report.elements) << " tetrahedra, " << grouped(report.colliders) << " colliders\n"
              << "  step          " << with_unit(stable_step, "s") << " (" << report.stable_step_body << "), "
              << grouped(static_cast<std::uint64_t>(scene.seconds / stable_step)) << " steps for "
              << short_number(scene.seconds) << " s\n"
              << "  cost          about " << with_unit(cost.seconds_per_second, "s")
              << " a simulated second, as it starts\n"
              << "  contacts      " << cost.contacts << " at the start\n";
    for (const BodyKindReport& kind : kinds)
        std::cout << "  body          " << kind.first_name
                  << (kind.count > 1 ? " and " + grouped(kind.count - 1) + " alike" : "") << ": "
                  << grouped(kind.mesh.tetrahedra) << " tetrahedra (" << name_of(kind.element) << "), mean edge "
                  << with_unit(kind.mesh.mean_edge, "m") << ", stable step " << with_unit(kind.stable_step, "s") << "; "
                  << materials_text(kind) << "\n";
    print_problems(problems);
    return exit_ok;
}

}  // namespace

int inspect(const InspectOptions& options) {
    return options.file.extension() == ".json" ? inspect_scene(options) : inspect_mesh(options);
}

}  // namespace skerry
