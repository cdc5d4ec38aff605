#include "engine/program/inspect_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <optional>

#include "engine/base/complaint.h"
#include "engine/mesh/formats/raw_mesh.h"
#include "engine/mesh/repair/surface_measures.h"
#include "engine/output/number_text.h"
#include "engine/program/inspect_repair.h"
#include "engine/program/start_text.h"
#include "engine/program/thin_part_text.h"
#include "skerry/surface_check.h"
#include "systems/collision/build_surface.h"

namespace skerry {

namespace {

// The stable step without the worst tetrahedra is printed only if it is at least this many times the stable step of the
// whole mesh. It may even be shorter than the latter, because the neighbours of removed tetrahedra lose mass.
constexpr Real least_gain = 1.1;

}  // namespace

void add_thin_part(const Mesh& mesh, std::span<const std::array<Index, 3>> boundary, const BodyCase& body_case,
                   Problems& problems) {
    if (std::string text = thin_part_text(mesh, boundary, body_case); !text.empty())
        problems.push_back(std::move(text));
}

void print_notes(const std::vector<std::string>& notes) {
    for (const std::string& note : notes) std::cout << "  note          " << note << "\n";
}

void print_problems(const Problems& problems) {
    if (problems.empty()) std::cout << "  problems      none found\n";
    for (const std::string& problem : problems) std::cout << "  problem       " << problem << "\n";
}

Json bound_json(const StepBound& bound) {
    Json worst = Json::array(), without = Json::array();
    for (const CostlyTetrahedron& t : bound.worst)
        worst.push_back(object_of({{"tetrahedron", t.tetrahedron},
                                   {"place", vector_json(t.place)},
                                   {"altitude", t.altitude},
                                   {"mean_edge", t.mean_edge},
                                   {"dt", t.step}}));
    for (const StepWithout& w : bound.without)
        without.push_back(object_of({{"share", w.share}, {"tetrahedra", w.count}, {"stable_dt", w.step}}));
    return object_of(
        {{"stable_dt", bound.step}, {"element", name_of(bound.element)}, {"worst", worst}, {"without", without}});
}

void print_bound(const StepBound& bound, const char* indent) {
    for (const CostlyTetrahedron& t : bound.worst)
        std::cout << indent << "tetrahedron " << t.tetrahedron << " at (" << short_text(t.place.x()) << ", "
                  << short_text(t.place.y()) << ", " << short_text(t.place.z()) << ") m allows a step of "
                  << with_unit(t.step, "s") << ": smallest altitude " << with_unit(t.altitude, "m") << ", mean edge "
                  << with_unit(t.mean_edge, "m") << "\n";
    for (const StepWithout& w : bound.without)
        if (const Real ratio = w.step / bound.step; ratio >= least_gain)
            std::cout << indent << "without the worst " << (w.count == 1 ? "one" : grouped(w.count)) << " ("
                      << short_text(100 * w.share) << " % of the tetrahedra): a step of " << with_unit(w.step, "s")
                      << ", " << short_text(ratio) << " times as long\n";
    if (bound.alike_share > 0)
        std::cout << indent << "removal of the worst " << short_text(100 * bound.alike_share)
                  << " % of the tetrahedra was not tried: their longest step is only " << short_text(bound.alike_ratio)
                  << " times their shortest\n";
}

namespace {

/// Reports a mesh of tetrahedra.
int report_mesh(const InspectOptions& options, const Mesh& mesh, const std::vector<std::string>& notes) {
    if (!options.repair.empty())
        return inspect_repair({.mesh = mesh,
                               .name = options.file.string(),
                               .body_case = {},
                               .step_of = "the default material, 1e5 Pa and 1000 kg/m^3",
                               .scaled = false},
                              options);
    const MeshReport report = inspect(mesh);
    Problems problems = problems_of(report);
    // A mesh without tetrahedra, or with inverted or flat tetrahedra, cannot be added to a world and has no stable
    // step.
    const bool is_body = report.tetrahedra > 0 && report.inverted + report.flat == 0;
    const StepBound bound = is_body ? step_bound(mesh, {}, true) : StepBound{};
    if (is_body) {
        std::vector<std::array<Index, 3>> boundary;
        for (const BoundaryTriangle& triangle : boundary_triangles(mesh.tetrahedra)) boundary.push_back(triangle.node);
        add_thin_part(mesh, boundary, {}, problems);
    }
    if (options.json) {
        Json json = object_of({{"schema", "skerry.mesh/1"}, {"file", options.file.string()}});
        json.update(mesh_json(report));
        if (is_body) json["step_bound"] = bound_json(bound);
        json["notes"] = notes;
        json["problems"] = problems;
        std::cout << json.dump(1) << std::endl;
        return exit_ok;
    }
    const Vec3 size = report.upper - report.lower;
    std::cout << options.file.string() << ": " << grouped(report.tetrahedra) << " tetrahedra, " << grouped(report.nodes)
              << " nodes, " << grouped(report.boundary_triangles) << " boundary triangles\n"
              << "  size          " << short_text(size.x()) << " x " << short_text(size.y()) << " x "
              << short_text(size.z()) << " m from " << short_text(report.lower) << " m, volume "
              << short_text(report.volume) << " m^3\n"
              << "  edges         mean " << with_unit(report.mean_edge, "m") << ", " << with_unit(report.min_edge, "m")
              << " to " << with_unit(report.max_edge, "m") << "; smallest altitude "
              << with_unit(report.min_altitude, "m") << "\n"
              << "  quality       mean " << short_text(report.mean_quality) << ", worst "
              << short_text(report.min_quality) << " (1: regular tetrahedron)\n"
              << "  boundary      " << (report.closed_manifold ? "a closed manifold" : "not a closed manifold") << ", "
              << grouped(report.components) << (report.components == 1 ? " part\n" : " parts\n");
    if (is_body) {
        std::cout << "  step          " << with_unit(bound.step, "s")
                  << " is stable with the default material, 1e5 Pa and 1000 kg/m^3 (elements: "
                  << name_of(bound.element) << ")\n";
        print_bound(bound, "                ");
    }
    if (!report.labels.empty()) std::cout << "  labels        " << labels_text(report) << "\n";
    for (const auto& [name, count] : report.sets) std::cout << "  set           " << set_text(name, count) << "\n";
    print_notes(notes);
    print_problems(problems);
    return exit_ok;
}

/// Returns the consequence of a fault of a surface, or the way to repair it.
const char* advice_on(SurfaceFaultKind kind) {
    using enum SurfaceFaultKind;
    switch (kind) {
        case flat_triangles:
        case duplicate_triangles:
        case duplicate_shells:
            return "delete them; a rigid body refuses them";
        case turned_triangles:
            return "make the normals consistent; a rigid body refuses them";
        case inside_out_shells:
            return "its triangles are clockwise as seen from outside: a collider of this surface holds bodies inside, "
                   "as a container; for a solid collider or a rigid body reverse the order of their nodes";
        case holes:
            return "close them; only a fixed or moving collider may have holes";
        case branching_edges:
        case pinched_nodes:
            return "separate the parts, or delete walls inside the solid; contacts may fail there";
        case one_sided_shells:
            return "the surface has no inside; cut it and model its thickness";
        case crossings:
        case shell_crossings:
        case overlaps:
            return "unite the parts (a Boolean union) or move them apart";
        case doubled_volumes:
            return "delete the inner surface or, if it bounds a void, reverse the order of the nodes of its triangles";
        case flat_shells:
            return "delete them, or give them a thickness";
        case slivers:
            return "remesh the surface, because they cause very short steps";
        case thin_walls:
            return "use shorter edges there, or a thicker wall";
        case unlikely_size:
            return "the program expects metres: set the scale of the mesh, for example 0.001";
    }
    return "";
}

/// Describes a shell, a connected part of the surface, for example "320 triangles from triangle 0, closed, 0.51 m^3, a
/// void in shell 1".
std::string shell_text(const SurfaceReport& report, const SurfaceShell& shell) {
    std::string text = grouped(shell.triangles) + (shell.triangles == 1 ? " triangle" : " triangles") +
                       " from triangle " + std::to_string(shell.triangle) +
                       (shell.closed ? ", closed, " + short_text(std::abs(shell.volume)) + " m^3" : ", open");
    if (shell.around != no_index)
        text +=
            std::string(shell.volume < 0 ? ", a void in shell " : ", inside shell ") + std::to_string(shell.around + 1);
    return report.shells.size() == 1 ? text : std::to_string(&shell - report.shells.data() + 1) + ": " + text;
}

Json surface_json(const InspectOptions& options, const SurfaceReport& report, const Problems& problems) {
    Json shells = Json::array(), faults = Json::array();
    for (const SurfaceShell& shell : report.shells)
        shells.push_back(object_of({{"triangles", shell.triangles},
                                    {"triangle", shell.triangle},
                                    {"closed", shell.closed},
                                    {"volume", shell.volume},
                                    {"around", shell.around == no_index ? Json() : Json(shell.around)}}));
    for (const SurfaceFault& fault : report.faults)
        faults.push_back(object_of({{"kind", name_of(fault.kind)},
                                    {"count", fault.count},
                                    {"triangle", fault.triangle},
                                    {"other", fault.other == no_index ? Json() : Json(fault.other)},
                                    {"place", vector_json(fault.place)},
                                    {"length", fault.length}}));
    const std::size_t closed = static_cast<std::size_t>(std::ranges::count(report.shells, true, &SurfaceShell::closed));
    return object_of(
        {{"schema", "skerry.surface/1"},
         {"file", options.file.string()},
         {"nodes", report.nodes},
         {"triangles", report.triangles},
         {"lower", vector_json(report.lower)},
         {"upper", vector_json(report.upper)},
         {"area", report.area},
         {"volume", closed > 0 ? Json(report.volume) : Json()},
         {"edge", object_of({{"min", report.min_edge}, {"mean", report.mean_edge}, {"max", report.max_edge}})},
         {"merged", report.merged},
         {"tolerance", report.tolerance},
         {"closed_manifold", closed == report.shells.size() && !report.find(SurfaceFaultKind::branching_edges) &&
                                 !report.find(SurfaceFaultKind::pinched_nodes)},
         {"can_be_filled", report.can_be_filled()},
         {"components", report.shells.size()},
         {"shells", shells},
         {"faults", faults},
         {"problems", problems}});
}

/// Reports a surface of triangles, from which a collider or a rigid body can be made.
int report_surface(const InspectOptions& options, const SurfaceMesh& surface) {
    const SurfaceReport report = mesh::check_surface(surface, mesh::default_weld, options.file.string());
    Problems problems;
    for (const SurfaceFault& fault : report.faults)
        problems.push_back(mesh::fault_text(fault) + "; " + advice_on(fault.kind));
    if (options.json) {
        std::cout << surface_json(options, report, problems).dump(1) << std::endl;
        return exit_ok;
    }
    constexpr std::size_t most_shells = 5;
    const Vec3 size = report.upper - report.lower;
    std::cout << options.file.string() << ": a surface of " << grouped(report.triangles) << " triangles, "
              << grouped(report.nodes) << " nodes\n"
              << "  size          " << short_text(size.x()) << " x " << short_text(size.y()) << " x "
              << short_text(size.z()) << " m from " << short_text(report.lower) << " m, area "
              << short_text(report.area) << " m^2"
              << (report.volume > 0 ? ", volume " + short_text(report.volume) + " m^3" : "") << "\n"
              << "  edges         mean " << with_unit(report.mean_edge, "m") << ", " << with_unit(report.min_edge, "m")
              << " to " << with_unit(report.max_edge, "m") << "\n"
              << "  welded        "
              << (report.merged == 0 ? std::string("no nodes")
                                     : grouped(report.merged) + (report.merged == 1 ? " node" : " nodes") + ", up to " +
                                           with_unit(report.tolerance, "m") + " apart")
              << "\n";
    for (std::size_t s = 0; s < std::min(report.shells.size(), most_shells); ++s)
        std::cout << "  shell         " << shell_text(report, report.shells[s]) << "\n";
    if (report.shells.size() > most_shells)
        std::cout << "                and " << grouped(report.shells.size() - most_shells) << " more shells\n";
    print_problems(problems);
    std::cout << "  next          "
              << (report.can_be_filled()
                      ? "the surface bounds a solid, which can be filled with tetrahedra as it is: skerry fill\n"
                      : "not a surface to be filled as it is; skerry fill can enclose it within a tolerance\n");
    return exit_ok;
}

/// Reads the surface of a file whose tetrahedra cannot be read. Returns nothing if the file has no surface either.
std::optional<SurfaceMesh> surface_instead(const InspectOptions& options) {
    try {
        return mesh::read_surface(options.file.string());
    } catch (const SceneError&) {
        return {};
    }
}

}  // namespace

int inspect_mesh(const InspectOptions& options) {
    if (!options.body.empty())
        refuse_in(options.file.string(), "--body", {}, "a mesh file, which has no bodies or settings",
                  "a scene file (.json)", "omit the option, or give the scene");
    const bool repairs = !options.repair.empty();  // only a mesh of tetrahedra can be repaired
    if (!repairs && mesh::is_surface_format(options.file.string()))
        return report_surface(options, mesh::read_surface(options.file.string()));
    std::optional<Mesh> mesh;
    std::vector<std::string> notes;
    try {
        mesh = mesh::read(options.file.string(), &notes);
    } catch (const SceneError&) {
        const std::optional<SurfaceMesh> surface = repairs ? std::nullopt : surface_instead(options);
        if (!surface) throw;
        return report_surface(options, *surface);
    }
    return report_mesh(options, *mesh, notes);
}

}  // namespace skerry
