#include "engine/program/inspect_repair.h"

#include <cstdio>
#include <iostream>

#include "engine/fill/meshers.h"
#include "engine/output/number_text.h"
#include "engine/program/progress.h"
#include "engine/program/repair.h"
#include "engine/program/require_writable.h"
#include "engine/scene/place.h"

namespace skerry {

namespace {

Json figures_json(const MeshFigures& figures) {
    return object_of({{"nodes", figures.mesh.nodes},
                      {"tetrahedra", figures.mesh.tetrahedra},
                      {"volume", figures.mesh.volume},
                      {"surface_area", figures.surface_area},
                      {"min_altitude", figures.mesh.min_altitude},
                      {"min_quality", figures.mesh.min_quality},
                      {"mean_quality", figures.mesh.mean_quality},
                      {"stable_dt", figures.step}});
}

std::string change(Real before, Real after) {
    if (!(before > 0)) return "";
    const Real ratio = after / before;
    if (ratio > 2) return short_text(ratio) + " times";
    const Real percent = 100 * (ratio - 1);
    if (percent > -1e-6 && percent < 1e-6) return "same";
    return (percent > 0 ? "+" : "") + short_text(percent) + " %";
}

void print_row(const char* name, const std::string& before, const std::string& after, const std::string& remark = {}) {
    std::printf("  %-16s %14s %14s   %s\n", name, before.c_str(), after.c_str(), remark.c_str());
}

void print_table(const RepairedMesh& repaired, const RepairTask& task) {
    const MeshFigures &a = repaired.before, &b = repaired.after;
    const auto real_row = [](const char* name, Real before, Real after, const char* unit) {
        print_row(name, with_unit(before, unit), with_unit(after, unit), change(before, after));
    };
    const auto count_row = [](const char* name, std::size_t before, std::size_t after) {
        print_row(name, grouped(before), grouped(after), change(static_cast<Real>(before), static_cast<Real>(after)));
    };
    std::printf("%s\n", task.name.c_str());
    print_row("", "before", "after");
    count_row("nodes", a.mesh.nodes, b.mesh.nodes);
    count_row("tetrahedra", a.mesh.tetrahedra, b.mesh.tetrahedra);
    print_row("volume [m^3]", short_text(a.mesh.volume, 6), short_text(b.mesh.volume, 6),
              change(a.mesh.volume, b.mesh.volume));
    print_row("surface [m^2]", short_text(a.surface_area, 6), short_text(b.surface_area, 6),
              change(a.surface_area, b.surface_area));
    real_row("worst altitude", a.mesh.min_altitude, b.mesh.min_altitude, "m");
    print_row("worst quality", short_text(a.mesh.min_quality), short_text(b.mesh.min_quality),
              "1: regular tetrahedron");
    print_row("mean quality", short_text(a.mesh.mean_quality), short_text(b.mesh.mean_quality));
    real_row("stable step", a.step, b.step, "s");
    std::printf("  stable steps with %s; %s edges of the surface were collapsed, %s were flipped\n",
                task.step_of.c_str(), grouped(repaired.collapsed).c_str(), grouped(repaired.flipped).c_str());
    if (repaired.parted > 0)
        std::printf("  %s split, because tetrahedra were connected there without a common face\n",
                    (grouped(repaired.parted) + (repaired.parted == 1 ? " node" : " nodes")).c_str());
    if (!a.mesh.sets.empty() && b.mesh.sets.empty())
        std::printf("  the new mesh has none of the sets of the mesh, because its nodes have other numbers\n");
    if (!repaired.reason_unchanged.empty())
        std::printf("  the tetrahedra are unchanged: %s\n", repaired.reason_unchanged.c_str());
    if (repaired.collapsed + repaired.flipped == 0) {
        std::printf("  the surface is unchanged\n");
        return;
    }
    std::printf(
        "  the surface moved by at most %s (distance of the new surface from the old one: %s, of the old from the new: "
        "%s; tolerance %s)\n",
        with_unit(repaired.distance.greatest(), "m").c_str(), with_unit(repaired.distance.from_second, "m").c_str(),
        with_unit(repaired.distance.from_first, "m").c_str(), with_unit(repaired.tolerance, "m").c_str());
}

void print_json(const RepairedMesh& repaired, const RepairTask& task, const InspectOptions& options) {
    const Json json = object_of({{"schema", "skerry.mesh_repair/1"},
                                 {"mesh", task.name},
                                 {"output", options.repair.string()},
                                 {"written", repaired.refusal.empty()},
                                 {"refusal", repaired.refusal},
                                 {"before", figures_json(repaired.before)},
                                 {"after", figures_json(repaired.after)},
                                 {"edges_collapsed", repaired.collapsed},
                                 {"edges_flipped", repaired.flipped},
                                 {"nodes_parted", repaired.parted},
                                 {"kept", repaired.reason_unchanged},
                                 {"tolerance", repaired.tolerance},
                                 {"distance", object_of({{"old_from_new", repaired.distance.from_first},
                                                         {"new_from_old", repaired.distance.from_second}})}});
    std::cout << json.dump(1) << std::endl;
}

}  // namespace

void check_repair(const InspectOptions& options) {
    const auto refuse = [&](const std::string& field, const std::string& found, const std::string& expected) {
        refuse_in(options.repair.string(), "--repair", field, found, expected);
    };
    if (options.repair.extension() != ".msh")
        refuse("file name",
               options.repair.has_extension() ? "the extension " + options.repair.extension().string()
                                              : std::string("no extension"),
               "the extension .msh");
    require_writable_file(options.repair);
    std::error_code none;
    if (!options.overwrite && std::filesystem::equivalent(options.repair, options.file, none))
        refuse("file name", "the input file", "a different file, or the option --overwrite");
    if (mesh::netgen_program().empty())
        skerry::refuse("--repair", {}, "no program skerry-fill in the folder of skerry or in PATH",
                       "the program skerry-fill, which is built if Netgen's library is installed",
                       mesh::install_netgen);
}

int inspect_repair(const RepairTask& task, const InspectOptions& options) {
    RepairedMesh repaired;
    {
        ActivityLine line(!options.json);
        repaired = repair(task.mesh, task.name, task.body_case, options.tolerance,
                          [&](const std::string& doing) { line.show(doing); });
        if (repaired.refusal.empty()) mesh::write(options.repair.string(), repaired.mesh);
    }
    if (options.json) print_json(repaired, task, options);
    if (!repaired.refusal.empty()) {
        std::cerr << "skerry: " << task.name << ": " << repaired.refusal << "; nothing was written\n";
        return exit_failed;
    }
    if (options.json) return exit_ok;
    print_table(repaired, task);
    std::cout << "  written       " << options.repair.string()
              << (task.scaled ? ", in metres; delete `scale` from the scene when you use this file" : "") << std::endl;
    return exit_ok;
}

}  // namespace skerry
