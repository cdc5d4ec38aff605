#include <algorithm>
#include <iostream>
#include <map>
#include <tuple>

#include "engine/program/cluster_text.h"
#include "engine/program/commands.h"
#include "engine/program/dynamics_text.h"
#include "engine/program/inspect_repair.h"
#include "engine/program/number_text.h"
#include "engine/program/plan_warnings.h"
#include "engine/program/progress.h"
#include "engine/program/run_plan.h"
#include "engine/program/start_text.h"
#include "engine/scene/scene_plan.h"

namespace skerry {

namespace {

using Problems = std::vector<std::string>;

// Tetrahedra of lower quality are slivers, which shorten the step and reduce accuracy.
constexpr Real poor_quality = 0.1;
// Ratio of the two smallest stable steps of bodies above which a problem is reported.
constexpr Real expensive_step_ratio = 4;
constexpr Real hardly_longer = 1.03;  // a ratio of step lengths between 1 and this value counts as a small gain
constexpr int timed_steps = 20;
constexpr std::size_t longest_list = 300;  // maximum length of a list of names in a message [characters]

Problems problems_of(const MeshReport& r) {
    Problems problems;
    if (r.tetrahedra == 0) problems.push_back("the mesh has no tetrahedra");
    if (r.inverted > 0)
        problems.push_back(grouped(r.inverted) + " inverted tetrahedra (of negative volume): a run refuses the mesh");
    if (r.flat > 0) problems.push_back(grouped(r.flat) + " flat tetrahedra (without volume): a run refuses the mesh");
    if (r.components > 1)
        problems.push_back(grouped(r.components) + " parts of the mesh are not connected to each other");
    if (r.tetrahedra > 0 && r.min_quality < poor_quality)
        problems.push_back("the worst tetrahedron is a sliver of quality " + short_number(r.min_quality) +
                           " (1: regular tetrahedron), which shortens the stable step");
    if (!r.closed_manifold) problems.push_back("the boundary is not a closed manifold: contacts may fail there");
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

Json bound_json(const StepBound& bound) {
    Json worst = Json::array(), without = Json::array();
    for (const CostlyTetrahedron& t : bound.worst)
        worst.push_back({{"tetrahedron", t.tetrahedron},
                         {"place", vector_json(t.place)},
                         {"altitude", t.altitude},
                         {"mean_edge", t.mean_edge},
                         {"dt", t.step}});
    for (const StepWithout& w : bound.without)
        without.push_back({{"share", w.share}, {"tetrahedra", w.count}, {"stable_dt", w.step}});
    return {{"stable_dt", bound.step}, {"element", name_of(bound.element)}, {"worst", worst}, {"without", without}};
}

/// Describes a ratio of stable steps: the step of the mesh without its worst tetrahedra, divided by the present step.
/// The ratio may be below 1, because removing tetrahedra reduces the mass of their nodes. This shortens the steps of
/// the neighbouring tetrahedra.
std::string compared(Real ratio) {
    if (ratio < 1 / hardly_longer) return short_number(ratio) + " times as long: shorter, because neighbours lose mass";
    if (ratio < 1) return "slightly shorter";
    return ratio < hardly_longer ? "slightly longer" : short_number(ratio) + " times as long";
}

/// Prints the tetrahedra that limit the stable step, and the stable step of the mesh without its worst tetrahedra.
void print_bound(const StepBound& bound, const char* indent) {
    for (const CostlyTetrahedron& t : bound.worst)
        std::cout << indent << "tetrahedron " << t.tetrahedron << " at (" << short_number(t.place.x()) << ", "
                  << short_number(t.place.y()) << ", " << short_number(t.place.z()) << ") m allows a step of "
                  << with_unit(t.step, "s") << ": smallest altitude " << with_unit(t.altitude, "m") << ", mean edge "
                  << with_unit(t.mean_edge, "m") << "\n";
    for (const StepWithout& w : bound.without)
        std::cout << indent << "without the worst " << (w.count == 1 ? "one" : grouped(w.count)) << " ("
                  << short_number(100 * w.share) << " % of the tetrahedra): a step of " << with_unit(w.step, "s")
                  << ", " << compared(w.step / bound.step) << "\n";
}

/// Returns the number of tetrahedra per label, for example "label 1: 300 tetrahedra, label 2: 20 tetrahedra". Only the
/// first 20 labels are listed.
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

int inspect_mesh(const InspectOptions& options) {
    if (!options.body.empty())
        Complaint{.file = options.file.string(),
                  .object = "--body",
                  .field = {},
                  .found = "a mesh file, which has no bodies or settings",
                  .expected = "a scene file (.json)",
                  .hint = "omit the option, or give the scene"}
            .raise();
    const Mesh mesh = mesh::read(options.file.string());
    if (!options.repair.empty())
        return inspect_repair({.mesh = mesh,
                               .what = options.file.string(),
                               .of = {},
                               .step_of = "the default material, 1e5 Pa and 1000 kg/m^3",
                               .scaled = false},
                              options);
    const MeshReport report = inspect(mesh);
    const Problems problems = problems_of(report);
    // A mesh without tetrahedra, or with inverted or flat tetrahedra, cannot be added to a world and has no stable
    // step.
    const bool is_body = report.tetrahedra > 0 && report.inverted + report.flat == 0;
    const StepBound bound = is_body ? step_bound(mesh, {}, true) : StepBound{};
    if (options.json) {
        Json json = {{"schema", "skerry.mesh/1"}, {"file", options.file.string()}};
        json.update(mesh_json(report));
        if (is_body) json["step_bound"] = bound_json(bound);
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
              << short_number(report.min_quality) << " (1: regular tetrahedron)\n"
              << "  boundary      " << (report.closed_manifold ? "a closed manifold" : "not a closed manifold") << ", "
              << grouped(report.components) << (report.components == 1 ? " part\n" : " parts\n");
    if (is_body) {
        std::cout << "  step          " << with_unit(bound.step, "s")
                  << " is stable with the default material, 1e5 Pa and 1000 kg/m^3 (elements: "
                  << name_of(bound.element) << ")\n";
        print_bound(bound, "                ");
    }
    if (!report.labels.empty()) std::cout << "  labels        " << labels_text(report) << "\n";
    print_problems(problems);
    return exit_ok;
}

/// Report on all bodies that have the same mesh, materials, elements and dynamics, and therefore the same stable step.
struct BodyKindReport {
    std::string first_name;
    // Name of each material of the bodies, and number of tetrahedra of this material (always above 0).
    std::vector<std::pair<std::string, std::size_t>> materials;
    std::size_t count = 0;
    std::size_t body = 0;  // index in ScenePlan::bodies of the first of these bodies
    MeshReport mesh;
    BodyDynamics dynamics;
    StepBound bound;  // for rigid and implicit bodies: no worst tetrahedra, and an infinite step

    bool sets_step() const { return dynamics != BodyDynamics::rigid && dynamics != BodyDynamics::implicit_elastic; }
};

/// Returns the input of step_bound for a body. The body is treated as explicit and elastic, so that its mesh has a
/// stable step even if its dynamics are rigid or implicit.
StepCase step_case(const ScenePlan& plan, const BodyPlan& body) {
    StepCase of{.settings = plan.settings,
                .material = plan.materials[body.material].second,
                .body = body.settings,
                .labelled = {}};
    of.body.dynamics = BodyDynamics::explicit_elastic;
    for (const auto& [label, material] : body.materials) of.labelled.emplace(label, plan.materials[material].second);
    return of;
}

/// Returns the number of tetrahedra of each material of a body: first the body's own material, then the materials of
/// its labels.
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

/// Groups the bodies by mesh, materials, elements and dynamics. The stable step of each explicit group is computed in a
/// separate world. `became`: dynamics of each body in the world; if empty, the dynamics of the plan are used.
std::vector<BodyKindReport> body_kinds(const ScenePlan& plan, bool details, std::span<const BodyDynamics> became = {}) {
    using Labels = std::vector<std::pair<int, std::size_t>>;
    std::map<std::tuple<std::size_t, std::size_t, Labels, ElementKind, BodyDynamics>, std::size_t> row;
    std::vector<BodyKindReport> kinds;
    for (std::size_t b = 0; b < plan.bodies.size(); ++b) {
        const BodyPlan& body = plan.bodies[b];
        const BodyDynamics dynamics = became.empty() ? body.settings.dynamics : became[b];
        const auto [at, is_new] =
            row.try_emplace({body.mesh, body.material, body.materials, body.settings.element, dynamics}, kinds.size());
        if (is_new) {
            const MeshReport mesh = inspect(plan.meshes[body.mesh]);
            kinds.push_back({body.settings.name,
                             count_materials(plan, body, mesh),
                             0,
                             b,
                             mesh,
                             dynamics,
                             {.step = infinity, .element = {}, .worst = {}, .without = {}}});
            if (kinds.back().sets_step())
                kinds.back().bound = step_bound(plan.meshes[body.mesh], step_case(plan, body), details);
        }
        ++kinds[at->second].count;
    }
    return kinds;
}

/// Describes the shape of a body, for example "192 tetrahedra (smoothed), mean edge 0.05 m" or
/// "a sphere of radius 0.1 m (rigid)".
std::string shape_text(const BodyPlan& body, const BodyKindReport& kind) {
    const std::string how(kind.sets_step() ? name_of(kind.bound.element) : name_of(kind.dynamics));
    if (const auto& sphere = body.shape.sphere)
        return "a sphere of radius " + with_unit(sphere->radius, "m") + " (" + how + ")";
    if (const auto& capsule = body.shape.capsule)
        return "a capsule of radius " + with_unit(capsule->radius, "m") + " and length " +
               with_unit(capsule->length, "m") + " (" + how + ")";
    if (const auto& cylinder = body.shape.cylinder)
        return "a cylinder of radius " + with_unit(cylinder->radius, "m") + " and height " +
               with_unit(cylinder->height, "m") + " (" + how + ")";
    return grouped(kind.mesh.tetrahedra) + " tetrahedra (" + how + "), mean edge " +
           with_unit(kind.mesh.mean_edge, "m");
}

/// Describes the materials of a body, for example "steel", or with numbers of tetrahedra "steel 300, rubber 20".
std::string materials_text(const BodyKindReport& kind) {
    if (kind.materials.size() == 1) return kind.materials.front().first;
    std::string text;
    for (const auto& [material, tetrahedra] : kind.materials)
        text += (text.empty() ? "" : ", ") + material + " " + grouped(tetrahedra);
    return text;
}

/// A scene in the state in which a run starts, and its overlaps before the run resolves them.
struct SceneStart {
    Scene scene;
    WorldReport as_written;  // report of a world in which the overlaps at the start are not resolved
    std::string outcome;     // how a run resolves the overlaps, as text; empty if there are none
};

SceneStart start_of(const ScenePlan& plan) {
    ScenePlan as_written = plan;
    as_written.settings.start_overlaps = StartOverlaps::ignore;
    SceneStart start{build_scene(as_written), {}, {}};
    start.as_written = start.scene.world.report();
    if (start.as_written.start_overlaps.empty()) return start;
    start.outcome = "a run starts with these overlaps, because settings.start_overlaps is \"ignore\"";
    if (plan.settings.start_overlaps == StartOverlaps::ignore) return start;
    try {
        start.scene = build_scene(plan);
        start.outcome = "a run moves overlapping bodies apart at the start: " + moves_text(start.scene.world.report());
    } catch (const SceneError& error) {
        start.outcome = std::string("a run refuses to start with these overlaps: ") + error.what();
    }
    return start;
}

struct SceneCost {
    double seconds_per_second = 0;  // wall time per simulated second, measured over the first steps
    Real overlap = 0;               // deepest overlap at the start [m]
    // Largest penetration into the contact distance at the start, minus the largest overlap [m].
    Real into_shell = 0;
    Index contacts = 0;  // number of contacts at the start
    std::string failure{}, turning{};
};

/// Runs the first steps, and measures their cost, overlaps and contacts. `overlap`: deepest overlap known so far [m].
SceneCost try_steps(World& world, Real overlap) {
    SceneCost cost{.overlap = overlap};
    // duration of a step that is long enough to find the contacts but moves hardly anything [s]
    constexpr Real hardly = 1e-9;
    const StepReport first = world.advance(hardly);
    cost.overlap = std::max(overlap, first.max_penetration);
    cost.into_shell = first.max_gap_violation - first.max_penetration;
    cost.contacts = first.contacts;
    if (!first.ok()) cost.failure = first.message();
    if (const WorldReport report = world.report(); report.collider_turn > visible_turn)
        cost.turning = turning_text(report);
    const Stopwatch watch;
    const Real duration = timed_steps * world.stable_step();
    const StepReport steps = world.advance(duration);
    if (!steps.ok()) cost.failure = steps.message();
    cost.seconds_per_second = watch.seconds() / duration;
    return cost;
}

Problems problems_of(Problems problems, const std::vector<BodyKindReport>& kinds, const SceneStart& start,
                     const SceneCost& cost) {
    for (const BodyKindReport& kind : kinds)
        for (const std::string& problem : problems_of(kind.mesh))
            problems.push_back("body \"" + kind.first_name + "\": " + problem);
    std::vector<BodyKindReport> by_step = kinds;
    std::erase_if(by_step, [](const BodyKindReport& kind) { return !kind.sets_step(); });
    std::sort(by_step.begin(), by_step.end(), [](const auto& a, const auto& b) { return a.bound.step < b.bound.step; });
    if (by_step.size() > 1 && by_step[1].bound.step > expensive_step_ratio * by_step[0].bound.step)
        problems.push_back("body \"" + by_step[0].first_name + "\" makes all steps " +
                           short_number(by_step[1].bound.step / by_step[0].bound.step) +
                           " times shorter than the other bodies require");
    constexpr std::size_t most_named = 20;
    const std::vector<StartOverlap>& overlaps = start.as_written.start_overlaps;
    for (std::size_t i = 0; i < overlaps.size() && i < most_named; ++i)
        problems.push_back(overlaps[i].message() + " at the start");
    if (overlaps.size() > most_named)
        problems.push_back(grouped(overlaps.size() - most_named) +
                           " more overlaps at the start; --json lists all overlaps");
    if (!overlaps.empty())
        problems.push_back(start.outcome);
    else if (cost.overlap > 0)
        problems.push_back("surfaces overlap by " + with_unit(cost.overlap, "m") +
                           " in the first step: move the bodies apart");
    Real shortest_edge = infinity;
    for (const BodyKindReport& kind : kinds) shortest_edge = std::min(shortest_edge, kind.mesh.mean_edge);
    if (!cost.turning.empty()) problems.push_back(cost.turning);
    if (cost.into_shell > visible_share * shortest_edge) problems.push_back(into_shell_text(cost.into_shell));
    if (!cost.failure.empty()) problems.push_back("the first steps of a run fail: " + cost.failure);
    return problems;
}

/// Returns the body whose mesh is to be repaired: the body that the user named, or else a body with the smallest stable
/// step.
const BodyPlan& body_to_mend(const ScenePlan& plan, const InspectOptions& options) {
    const auto refuse = [&](const std::string& object, const std::string& found, const std::string& expected) {
        Complaint{options.file.string(), object, {}, found, expected, {}}.raise();
    };
    if (plan.bodies.empty()) refuse("bodies", "no bodies", "at least one body, whose mesh --repair can improve");
    if (options.body.empty()) {
        const std::vector<BodyKindReport> kinds = body_kinds(plan, false);
        const auto least = std::min_element(kinds.begin(), kinds.end(),
                                            [](const auto& a, const auto& b) { return a.bound.step < b.bound.step; });
        return plan.bodies[least->body];
    }
    const auto named = std::find_if(plan.bodies.begin(), plan.bodies.end(),
                                    [&](const BodyPlan& body) { return body.settings.name == options.body; });
    if (named == plan.bodies.end()) {
        std::string names;
        for (const BodyPlan& body : plan.bodies)
            if (names.size() < longest_list) names += (names.empty() ? "\"" : ", \"") + body.settings.name + "\"";
        refuse("--body", "\"" + options.body + "\"", "one of the bodies " + names);
    }
    return *named;
}

int inspect_scene(const InspectOptions& options) {
    RunOptions run;
    run.scene = options.file;
    run.overrides.assignments = options.assignments;
    const ScenePlan plan = plan_scene(options.file, run.overrides);
    if (!options.repair.empty()) {
        const BodyPlan& body = body_to_mend(plan, options);
        return inspect_repair({.mesh = plan.meshes[body.mesh],
                               .what = options.file.string() + ": body \"" + body.settings.name + "\"",
                               .of = step_case(plan, body),
                               .step_of = "material \"" + plan.materials[body.material].first + "\"",
                               .scaled = true},
                              options);
    }
    SceneStart start = start_of(plan);
    Scene& scene = start.scene;
    std::vector<BodyDynamics> became;
    for (const BodyHandle body : scene.world.bodies()) became.push_back(scene.world.dynamics(body));
    const std::vector<BodyKindReport> kinds = body_kinds(plan, true, became);
    const WorldReport report = scene.world.report();
    const Real stable_step = scene.world.stable_step();
    const double steps = plan_run(scene, run).steps(scene.world);
    Real overlap = 0;
    for (const StartOverlap& found : start.as_written.start_overlaps) overlap = std::max(overlap, found.depth);
    const SceneCost cost = try_steps(scene.world, overlap);
    const Problems problems = problems_of(plan_warnings(plan), kinds, start, cost);
    if (options.json) {
        Json bodies = Json::array();
        for (const BodyKindReport& kind : kinds) {
            Json materials = Json::object();
            for (const auto& [material, tetrahedra] : kind.materials) materials[material] = tetrahedra;
            Json body = {{"name", kind.first_name},
                         {"count", kind.count},
                         {"dynamics", name_of(kind.dynamics)},
                         {"materials", materials},
                         {"mesh", mesh_json(kind.mesh)}};
            const BodyShapeEntry& shape = plan.bodies[kind.body].shape;
            if (shape.sphere) body["sphere_radius"] = shape.sphere->radius;
            if (shape.capsule) body["capsule"] = {{"radius", shape.capsule->radius}, {"length", shape.capsule->length}};
            if (shape.cylinder)
                body["cylinder"] = {{"radius", shape.cylinder->radius}, {"height", shape.cylinder->height}};
            if (kind.sets_step())
                body.update({{"stable_dt", kind.bound.step},
                             {"element", name_of(kind.bound.element)},
                             {"step_bound", bound_json(kind.bound)}});
            bodies.push_back(body);
        }
        const Json json = {{"schema", "skerry.scene_facts/1"},
                           {"scene", scene.name},
                           {"description", scene.description},
                           {"seconds", scene.seconds},
                           {"bodies", report.bodies},
                           {"colliders", report.colliders},
                           {"joints", plan.joints.size()},
                           {"nodes", report.nodes},
                           {"elements", report.elements},
                           {"stable_dt", stable_step},
                           {"stable_dt_body", report.stable_step_body},
                           {"steps", steps},
                           {"dynamics_choices", choices_json(report)},
                           {"clusters",
                            {{"count", report.clusters},
                             {"nodes", report.cluster_nodes},
                             {"implicit_elements", report.implicit_elements},
                             {"guards", report.guards}}},
                           {"contacts_at_start", cost.contacts},
                           {"overlap_at_start", cost.overlap},
                           {"start_overlaps", overlaps_json(start.as_written)},
                           {"wall_seconds_per_second", cost.seconds_per_second},
                           {"wall_seconds", cost.seconds_per_second * scene.seconds},
                           {"body_kinds", bodies},
                           {"problems", problems}};
        std::cout << json.dump(1) << std::endl;
        return exit_ok;
    }
    std::cout << scene.name << ": " << scene.description << "\n"
              << "  bodies        " << grouped(report.bodies) << ", " << grouped(report.nodes) << " nodes, "
              << grouped(report.elements) << " tetrahedra, " << grouped(report.colliders) << " colliders"
              << (plan.joints.empty() ? "" : ", " + grouped(plan.joints.size()) + " joints") << "\n"
              << (report.clusters > 0 ? "  clusters      " + cluster_text(report) + "\n" : "")  //
              << "  step          " << with_unit(stable_step, "s") << " ("
              << (report.stable_step_body.empty() ? "no body limits the step" : "limited by " + report.stable_step_body)
              << "), " << count_text(steps) << " steps for " << short_number(scene.seconds) << " s\n"
              << "  cost          about " << duration_text(cost.seconds_per_second)
              << " of wall time per simulated second, estimated from the first steps; "
              << duration_text(cost.seconds_per_second * scene.seconds) << " for the whole run\n"
              << "  contacts      " << cost.contacts << " at the start\n";
    for (const std::string& choice : choice_texts(report)) std::cout << "  dynamics      " << choice << "\n";
    for (const BodyKindReport& kind : kinds) {
        std::cout << "  body          " << kind.first_name
                  << (kind.count > 1
                          ? " and " + grouped(kind.count - 1) + " more with the same mesh, material and dynamics"
                          : "")
                  << ": " << shape_text(plan.bodies[kind.body], kind)
                  << (kind.sets_step() ? ", stable step " + with_unit(kind.bound.step, "s") : "") << "; "
                  << materials_text(kind) << "\n";
        if (kind.sets_step()) print_bound(kind.bound, "                ");
    }
    print_problems(problems);
    return exit_ok;
}

}  // namespace

int inspect(const InspectOptions& options) {
    if (!options.repair.empty()) check_repair(options);
    if (options.file.extension() == ".json") return inspect_scene(options);
    if (!options.assignments.empty())
        Complaint{.file = options.file.string(),
                  .object = "--set",
                  .field = {},
                  .found = "a mesh file, which has no bodies or settings",
                  .expected = "a scene file (.json)",
                  .hint = "omit the option, or give the scene"}
            .raise();
    return inspect_mesh(options);
}

}  // namespace skerry
