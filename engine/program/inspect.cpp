#include <algorithm>
#include <initializer_list>
#include <iostream>
#include <map>
#include <tuple>
#include <utility>

#include "engine/base/complaint.h"
#include "engine/output/number_text.h"
#include "engine/program/cluster_text.h"
#include "engine/program/commands.h"
#include "engine/program/dynamics_text.h"
#include "engine/program/inspect_mesh.h"
#include "engine/program/inspect_repair.h"
#include "engine/program/mesh_text.h"
#include "engine/program/plan_warnings.h"
#include "engine/program/progress.h"
#include "engine/program/run_plan.h"
#include "engine/program/start_text.h"
#include "engine/program/trial.h"
#include "engine/scene/scene_plan.h"

namespace skerry {

namespace {

// A problem is reported if one kind of explicit bodies (see BodyKindReport) needs steps that are shorter by more than
// this factor than the steps that every other kind needs.
constexpr Real expensive_step_ratio = 4;
constexpr std::size_t longest_list = 300;  // a list of names in a message ends once it is this long [characters]

/// Report on all bodies that have the same mesh, materials, elements and dynamics, and therefore the same stable step.
struct BodyKindReport {
    std::string first_name;
    // Name of each material of the bodies, and number of tetrahedra of this material. Materials without tetrahedra are
    // omitted, unless the bodies have no tetrahedra at all.
    std::vector<std::pair<std::string, std::size_t>> materials;
    std::size_t count = 0;
    std::size_t body = 0;  // index in ScenePlan::bodies of the first of these bodies
    MeshReport mesh;
    BodyDynamics dynamics;
    StepBound bound;  // for rigid and implicit bodies: no worst tetrahedra, and an infinite step

    bool sets_step() const { return dynamics != BodyDynamics::rigid && dynamics != BodyDynamics::implicit_elastic; }
};

/// Returns the number of tetrahedra of each material of a body: first the body's own material, then the materials of
/// labelled parts of its mesh.
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
        if (tetrahedra > 0 || mesh.tetrahedra == 0) named.emplace_back(plan.materials[material].first, tetrahedra);
    return named;
}

/// Groups the bodies by mesh, materials, elements and dynamics. `built`: world built from the plan, before its first
/// step is planned; may be null.
/// - With a world, the dynamics are those of the bodies in it, and the result has details of their stable steps.
/// - Without a world, the dynamics are those of the plan. The stable step of each explicit group is computed in a
///   separate world.
std::vector<BodyKindReport> body_kinds(const ScenePlan& plan, World* built = nullptr) {
    using Labels = std::vector<std::pair<int, std::size_t>>;
    std::map<std::tuple<std::size_t, std::size_t, Labels, ElementKind, BodyDynamics>, std::size_t> row;
    std::vector<BodyKindReport> kinds;
    const std::vector<BodyHandle> handles = built == nullptr ? std::vector<BodyHandle>() : bodies_in_order(*built);
    for (std::size_t b = 0; b < plan.bodies.size(); ++b) {
        const BodyPlan& body = plan.bodies[b];
        const BodyDynamics dynamics = built == nullptr ? body.settings.dynamics : built->dynamics(handles[b]);
        const auto [at, is_new] =
            row.try_emplace({body.mesh, body.material, body.materials, body.settings.element, dynamics}, kinds.size());
        if (is_new) {
            const Mesh& mesh_of_body = plan.meshes[body.mesh];
            const MeshReport mesh = inspect(mesh_of_body);
            kinds.push_back({body.settings.name,
                             count_materials(plan, body, mesh),
                             0,
                             b,
                             mesh,
                             dynamics,
                             {.step = infinity, .element = {}, .worst = {}, .without = {}}});
            if (kinds.back().sets_step())
                kinds.back().bound = built == nullptr
                                         ? step_bound(mesh_of_body, body_case_of(plan, body), false)
                                         : step_bound(*built, handles[b], mesh_of_body, body_case_of(plan, body));
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
    const bool is_surface = kind.mesh.tetrahedra == 0;
    return grouped(is_surface ? kind.mesh.boundary_triangles : kind.mesh.tetrahedra) +
           (is_surface ? " triangles (" : " tetrahedra (") + how + "), mean edge " +
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

/// A scene in the state in which a run starts, and a report of the overlaps in the scene file, which a run may resolve.
struct SceneStart {
    Scene scene;
    WorldReport as_written;  // report of a world in which the overlaps at the start are not resolved
    std::string outcome;     // how a run resolves the overlaps, as text; empty if there are none
};

/// Builds the scene as a run would start with it. `as_written`: scene of the plan, built without resolving the overlaps
/// at the start.
SceneStart start_of(const ScenePlan& plan, Scene as_written) {
    SceneStart start{std::move(as_written), {}, {}};
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

Problems problems_of(const ScenePlan& plan, const std::vector<BodyKindReport>& kinds, const SceneStart& start,
                     const SceneCost& cost) {
    Problems problems = plan_warnings(plan);
    const World& world = start.scene.world;
    const std::vector<BodyHandle> bodies = bodies_in_order(world);
    for (const BodyKindReport& kind : kinds) {
        Problems of_kind = problems_of(kind.mesh);
        if (kind.dynamics != BodyDynamics::rigid)
            add_thin_part(plan.meshes[plan.bodies[kind.body].mesh], world.surface(bodies[kind.body]),
                          body_case_of(plan, plan.bodies[kind.body]), of_kind);
        for (const std::string& problem : of_kind)
            problems.push_back(mesh_of_body_text(plan, kind.body) + ": " + problem);
    }
    std::vector<BodyKindReport> by_step = kinds;
    std::erase_if(by_step, [](const BodyKindReport& kind) { return !kind.sets_step(); });
    std::sort(by_step.begin(), by_step.end(), [](const auto& a, const auto& b) { return a.bound.step < b.bound.step; });
    if (by_step.size() > 1 && by_step[1].bound.step > expensive_step_ratio * by_step[0].bound.step)
        problems.push_back("body \"" + by_step[0].first_name + "\" makes all steps " +
                           short_text(by_step[1].bound.step / by_step[0].bound.step) +
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
        refuse_in(options.file.string(), object, {}, found, expected);
    };
    if (plan.bodies.empty()) refuse("bodies", "no bodies", "at least one body, whose mesh --repair can improve");
    if (options.body.empty()) {
        const std::vector<BodyKindReport> kinds = body_kinds(plan);
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
    const ScenePlan plan = plan_with_progress(options.file, run.overrides, true);
    if (!options.repair.empty()) {
        const BodyPlan& body = body_to_mend(plan, options);
        return inspect_repair({.mesh = plan.meshes[body.mesh],
                               .name = options.file.string() + ": body \"" + body.settings.name + "\"",
                               .body_case = body_case_of(plan, body),
                               .step_of = "material \"" + plan.materials[body.material].first + "\"",
                               .scaled = true},
                              options);
    }
    ScenePlan as_written = plan;
    as_written.settings.start_overlaps = StartOverlaps::ignore;
    SetupProgress progress(true, plan);
    Scene built = build_scene(as_written, [&](std::size_t bodies) { progress.added(bodies); });
    progress.begin("measuring the meshes");
    const std::vector<BodyKindReport> kinds = body_kinds(plan, &built.world);
    progress.begin("choosing the step length");
    SceneStart start = start_of(plan, std::move(built));
    Scene& scene = start.scene;
    const WorldReport report = scene.world.report();
    const Real stable_step = scene.world.stable_step();
    Real overlap = 0;
    for (const StartOverlap& found : start.as_written.start_overlaps) overlap = std::max(overlap, found.depth);
    Json sliders = Json::array();
    for (const Slider& slider : scene.sliders)
        sliders.push_back(object_of({{"name", slider.name},
                                     {"unit", slider.unit},
                                     {"value", slider_value(scene.world, slider)},
                                     {"low", slider.low},
                                     {"high", slider.high}}));
    progress.begin("timing the first steps");
    const SceneCost cost =
        try_run(scene.world, plan_run(scene, run.scene, run.seconds, run.frames_per_second), overlap);
    const Problems problems = problems_of(plan, kinds, start, cost);
    std::size_t surfaces = 0;
    for (const BodyPlan& body : plan.bodies) surfaces += body.surfaces.size();
    if (options.json) {
        Json bodies = Json::array();
        for (const BodyKindReport& kind : kinds) {
            Json materials = Json::object();
            for (const auto& [material, tetrahedra] : kind.materials) materials[material] = tetrahedra;
            Json body = object_of({{"name", kind.first_name},
                                   {"count", kind.count},
                                   {"dynamics", name_of(kind.dynamics)},
                                   {"materials", materials},
                                   {"mesh", mesh_json(kind.mesh)}});
            const BodyShapeEntry& shape = plan.bodies[kind.body].shape;
            if (shape.sphere) body["sphere_radius"] = shape.sphere->radius;
            if (shape.capsule)
                body["capsule"] = object_of({{"radius", shape.capsule->radius}, {"length", shape.capsule->length}});
            if (shape.cylinder)
                body["cylinder"] = object_of({{"radius", shape.cylinder->radius}, {"height", shape.cylinder->height}});
            if (kind.sets_step())
                body.update(object_of({{"stable_dt", kind.bound.step},
                                       {"element", name_of(kind.bound.element)},
                                       {"step_bound", bound_json(kind.bound)}}));
            bodies.push_back(body);
        }
        const Json json = object_of({{"schema", "skerry.scene_facts/1"},
                                     {"scene", scene.name},
                                     {"description", scene.description},
                                     {"seconds", scene.seconds},
                                     {"bodies", report.bodies},
                                     {"colliders", report.colliders},
                                     {"joints", plan.joints.size()},
                                     {"ties", plan.ties.size()},
                                     {"cables", plan.cables.size()},
                                     {"cavities", plan.cavities.size()},
                                     {"pipes", plan.pipes.size()},
                                     {"loads", plan.loads.size()},
                                     {"fibres", plan.fibres.size()},
                                     {"springs", plan.springs.size()},
                                     {"pairs", plan.pairs.size()},
                                     {"surfaces", surfaces},
                                     {"sliders", sliders},
                                     {"nodes", report.nodes},
                                     {"elements", report.elements},
                                     {"stable_dt", stable_step},
                                     {"stable_dt_body", report.stable_step_body},
                                     {"steps", cost.steps},
                                     {"dynamics_choices", choices_json(report)},
                                     {"clusters", object_of({{"count", report.clusters},
                                                             {"nodes", report.cluster_nodes},
                                                             {"implicit_elements", report.implicit_elements},
                                                             {"guards", report.guards}})},
                                     {"contacts_at_start", cost.contacts},
                                     {"overlap_at_start", cost.overlap},
                                     {"start_overlaps", overlaps_json(start.as_written)},
                                     {"trial_seconds", cost.simulated},
                                     {"wall_seconds_per_second", cost.seconds / scene.seconds},
                                     {"wall_seconds", cost.seconds},
                                     {"body_kinds", bodies},
                                     {"notes", plan.notes},
                                     {"problems", problems}});
        std::cout << json.dump(1) << std::endl;
        return exit_ok;
    }
    std::string joined;
    for (const auto& [count, one, several] : std::initializer_list<std::tuple<std::size_t, const char*, const char*>>{
             {plan.joints.size(), "joint", "joints"},
             {plan.ties.size(), "tie", "ties"},
             {plan.cables.size(), "cable", "cables"},
             {plan.cavities.size(), "cavity", "cavities"},
             {plan.pipes.size(), "pipe", "pipes"},
             {plan.loads.size(), "load", "loads"},
             {plan.fibres.size(), "family of fibres", "families of fibres"},
             {plan.springs.size(), "spring", "springs"},
             {plan.pairs.size(), "pair of materials", "pairs of materials"},
             {surfaces, "surface set", "surface sets"}})
        if (count > 0) joined += ", " + grouped(count) + " " + (count == 1 ? one : several);
    std::cout << scene.name << (scene.description.empty() ? "" : ": ") << scene.description << "\n"
              << "  bodies        " << grouped(report.bodies) << ", " << grouped(report.nodes) << " nodes, "
              << grouped(report.elements) << " tetrahedra, " << grouped(report.colliders)
              << (report.colliders == 1 ? " collider" : " colliders") << joined << "\n"
              << (report.clusters > 0 ? "  clusters      " + cluster_text(report) + "\n" : "")  //
              << "  step          " << with_unit(stable_step, "s") << " ("
              << (report.stable_step_body.empty() ? "no body limits the step" : "limited by " + report.stable_step_body)
              << "), " << count_text(cost.steps) << " steps for " << short_text(scene.seconds) << " s\n"
              << "  cost          about " << duration_text(cost.seconds) << " of wall time for the whole run, "
              << duration_text(cost.seconds / scene.seconds) << " per simulated second, "
              << (cost.complete ? "measured in a trial of the whole run"
                                : "estimated from a trial of the first " + short_text(cost.simulated) + " s")
              << "\n"
              << "  contacts      " << cost.contacts << " at the start\n";
    for (const std::string& choice : choice_texts(report)) std::cout << "  dynamics      " << choice << "\n";
    for (const Slider& slider : scene.sliders)
        std::cout << "  slider        " << slider.name << ": from " << short_text(slider.low) << " to "
                  << short_text(slider.high) << (slider.unit == "1" ? "" : " " + slider.unit) << "\n";
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
    print_notes(plan.notes);
    print_problems(problems);
    return exit_ok;
}

}  // namespace

int inspect(const InspectOptions& options) {
    if (!options.repair.empty()) check_repair(options);
    if (options.file.extension() == ".json") return inspect_scene(options);
    if (!options.assignments.empty())
        refuse_in(options.file.string(), "--set", {}, "a mesh file, which has no bodies or settings",
                  "a scene file (.json)", "omit the option, or give the scene");
    return inspect_mesh(options);
}

}  // namespace skerry
