// The command `skerry fill`.
#include "skerry/fill.h"

#include <cmath>
#include <iostream>

#include "engine/base/complaint.h"
#include "engine/base/write_file.h"
#include "engine/mesh/repair/surface_measures.h"
#include "engine/output/number_text.h"
#include "engine/program/commands.h"
#include "engine/program/inspect_mesh.h"
#include "engine/program/progress.h"
#include "engine/program/require_writable.h"
#include "engine/scene/write_scene.h"
#include "skerry/materials.h"

namespace skerry {

namespace {

void check_outputs(const FillOptions& options) {
    if (options.mesh.extension() != ".msh")
        refuse_in(options.mesh.string(), {}, "file name",
                  options.mesh.has_extension() ? "the extension " + options.mesh.extension().string() : "no extension",
                  "the extension .msh", "the last file is the mesh to write: skerry fill SURFACE OUT.msh");
    std::vector<NamedFile> files{{"the mesh", options.mesh}, {"--scene", options.scene}};
    for (const std::filesystem::path& surface : options.surfaces) files.push_back({"SURFACE", surface});
    require_distinct(files);
    require_writable_file(options.mesh);
    if (!options.scene.empty()) require_writable_file(options.scene);
}

/// Returns a scene in which the body falls on a floor. At the start the gap between the body and the floor is half the
/// height of the body, rounded up.
Json starter_scene(const FillOptions& options, const MaterialSettings& given, const MeshReport& report) {
    const Real gravity = 9.81, height = report.upper.z() - report.lower.z(), fall = height / 2;
    const Real rounding = std::pow(10, std::ceil(std::log10(height)) - 3);
    // Six times the duration of the fall, rounded up to 0.1 s: enough for the body to come to rest.
    const Real seconds = std::ceil(60 * std::sqrt(2 * fall / gravity)) / 10;
    Json material = object_of(
        {{"young_modulus", given.young_modulus}, {"poisson_ratio", given.poisson_ratio}, {"density", given.density}});
    if (!options.material.empty()) material = object_of({{"like", options.material}});
    const std::string name = options.surfaces.front().stem().string();
    Json body = object_of({{"name", name},
                           {"mesh", object_of({{"file", path_in_scene(options.mesh, options.scene)}})},
                           {"material", "body"},
                           {"position", {0, 0, std::ceil((fall - report.lower.z()) / rounding) * rounding}}});
    if (options.surfaces.size() == 1) {
        body["visual"] = object_of({{"file", path_in_scene(options.surfaces.front(), options.scene)}});
        if (options.settings.scale != 1) body["visual"]["scale"] = options.settings.scale;
    }
    return object_of(
        {{"description", name + " falls on a floor."},
         {"seconds", seconds},
         {"materials", object_of({{"body", material}})},
         {"bodies", Json::array({body})},
         {"colliders",
          Json::array({object_of({{"name", "floor"}, {"shape", object_of({{"plane", Json::object()}})}})})}});
}

Json fill_json(const FillOptions& options, const mesh::FilledMesh& filled, const MeshReport& report,
               const Problems& problems, double seconds) {
    const mesh::SurfaceDistance& distance = filled.distance;
    return object_of({{"schema", "skerry.fill/1"},
                      {"output", options.mesh.string()},
                      {"mesher", filled.mesher},
                      {"exact", filled.exact},
                      {"seconds", seconds},
                      {"surface_triangles", filled.surface.triangles},
                      {"surface_volume", filled.surface_volume ? Json(*filled.surface_volume) : Json()},
                      {"tolerance", filled.tolerance},
                      {"distance", object_of({{"surface_to_mesh", distance.from_first},
                                              {"mesh_to_surface", distance.from_second},
                                              {"mean_surface_to_mesh", distance.mean_from_first},
                                              {"mean_mesh_to_surface", distance.mean_from_second}})},
                      {"stable_dt", filled.stable_step},
                      {"mesh", mesh_json(report)},
                      {"notes", filled.notes},
                      {"problems", problems}});
}

void print_text(const FillOptions& options, const mesh::FilledMesh& filled, const MeshReport& report,
                const Problems& problems, double seconds) {
    const mesh::SurfaceDistance& distance = filled.distance;
    std::cout << options.mesh.string() << ": " << grouped(report.tetrahedra) << " tetrahedra, " << grouped(report.nodes)
              << " nodes\n"
              << summary_line("surface", grouped(filled.surface.triangles) + " triangles, mean edge " +
                                             with_unit(filled.surface.mean_edge, "m"))
              << summary_line("filled by", filled.mesher + " in " + duration_text(seconds));
    std::string volume = short_text(report.volume, 6) + " m^3";
    if (filled.surface_volume && *filled.surface_volume > 0)
        volume += ", " + percent(std::abs(report.volume / *filled.surface_volume - 1)) + " from that of the surface";
    std::cout << summary_line("volume", volume);
    const std::string merged =
        filled.surface.merged > 0 ? " after " + grouped(filled.surface.merged) + " nodes were merged with others" : "";
    if (filled.exact)
        std::cout << summary_line("distance", "0, the surface is unchanged" + merged);
    else
        std::cout << summary_line("distance", "from the surface to the mesh up to " +
                                                  with_unit(distance.from_first, "m") + ", mean " +
                                                  with_unit(distance.mean_from_first, "m"))
                  << summary_line("", "from the mesh to the surface up to " + with_unit(distance.from_second, "m") +
                                          ", mean " + with_unit(distance.mean_from_second, "m") + "; tolerance " +
                                          with_unit(filled.tolerance, "m"));
    std::cout << summary_line("quality", "mean " + short_text(report.mean_quality) + ", worst " +
                                             short_text(report.min_quality) + " (1: regular tetrahedron)")
              << summary_line("step", with_unit(filled.stable_step, "s") + " is stable with " +
                                          (options.material.empty() ? "the default material, 1e5 Pa and 1000 kg/m^3"
                                                                    : "the material " + in_quotes(options.material)));
    if (!report.labels.empty()) std::cout << summary_line("labels", labels_text(report));
    print_notes(filled.notes);
    print_problems(problems);
    std::cout << summary_line("written", options.mesh.string());
    if (!options.scene.empty())
        std::cout << summary_line("", options.scene.string() + "; next: skerry run " + options.scene.string() +
                                          " --page " + options.scene.stem().string() + ".html");
}

}  // namespace

int fill(const FillOptions& options) {
    check_outputs(options);
    mesh::FillSettings settings = options.settings;
    if (!options.material.empty()) settings.material = named_material(options.material);
    const Stopwatch watch;
    mesh::FilledMesh filled;
    {
        ActivityLine line(!options.json);
        filled = mesh::fill(options.surfaces, settings, [&](const std::string& activity) { line.show(activity); });
    }
    const double seconds = watch.seconds();
    const MeshReport report = inspect(filled.mesh);
    Problems problems = problems_of(report);
    BodyCase body_case;
    body_case.material = settings.material;
    add_thin_part(filled.mesh, mesh::boundary(filled.mesh).triangles, body_case, problems);
    mesh::write(options.mesh.string(), filled.mesh);
    if (!options.scene.empty())
        write_file(options.scene, [&](std::ostream& out) {
            out << starter_scene(options, settings.material, report).dump(4, ' ', false, Json::error_handler_t::replace)
                << "\n";
        });
    if (options.json)
        // File names may contain bytes that are not UTF-8. These are replaced, because dump() would otherwise throw.
        std::cout
            << fill_json(options, filled, report, problems, seconds).dump(1, ' ', false, Json::error_handler_t::replace)
            << std::endl;
    else
        print_text(options, filled, report, problems, seconds);
    return exit_ok;
}

}  // namespace skerry
