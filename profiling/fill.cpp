// Fills the test surfaces, which have the faults of users' files, and the surfaces of given files, and prints a table
// (CSV).
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "skerry/error.h"
#include "skerry/fill.h"
#include "tests/support/surface_corpus.h"

namespace {

using namespace skerry;

std::string kinds_of(const SurfaceReport& report) {
    std::string kinds;
    for (const SurfaceFault& fault : report.faults)
        kinds += (kinds.empty() ? "" : " ") + std::string(name_of(fault.kind));
    return kinds;
}

void print_row(const std::string& name, const std::function<mesh::FilledMesh()>& fill) {
    const auto start = std::chrono::steady_clock::now();
    try {
        const mesh::FilledMesh filled = fill();
        const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
        const MeshReport report = inspect(filled.mesh);
        std::string volume;
        if (filled.surface_volume) {
            char text[32];
            std::snprintf(text, sizeof text, "%.1e", std::abs(report.volume / *filled.surface_volume - 1));
            volume = text;
        }
        std::printf("%s,%s,%zu,%s,%.1f,%zu,%.2f,%.2f,%s,%.2g,%.2g,%.2g\n", name.c_str(),
                    kinds_of(filled.surface).c_str(), filled.surface.triangles, filled.mesher.c_str(), elapsed.count(),
                    report.tetrahedra, report.min_quality, report.mean_quality, volume.c_str(),
                    filled.distance.from_first / filled.tolerance, filled.distance.from_second / filled.tolerance,
                    filled.stable_step);
    } catch (const SceneError& error) {
        std::printf("%s,,,refused,,,,,,,,\n", name.c_str());
        std::fprintf(stderr, "%s\n", error.what());
    }
    std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Fills test surfaces with tetrahedra and prints a table", "profile_fill");
    std::vector<std::filesystem::path> files;
    mesh::FillSettings settings;
    bool million = false, no_corpus = false;
    app.add_option("SURFACE", files, "surface files to be filled as well");
    app.add_option("--tolerance", settings.tolerance, "option of `skerry fill`")->capture_default_str();
    app.add_option("--time-limit", settings.limits.seconds, "option of `skerry fill` [s]")->capture_default_str();
    app.add_flag("--million", million, "also fill a surface of a million triangles with edges of 0.1 m");
    app.add_flag("--files-only", no_corpus, "leave the test surfaces out");
    CLI11_PARSE(app, argc, argv);
    std::printf(
        "surface,faults,triangles,mesher,time [s],tetrahedra,worst quality,mean quality,volume error,"
        "distance from surface / tolerance,distance from mesh / tolerance,step [s]\n");
    if (!no_corpus)
        for (const test::CorpusSurface& corpus_surface : test::surface_corpus())
            print_row(corpus_surface.name,
                      [&] { return mesh::fill(corpus_surface.surface, corpus_surface.name, settings); });
    for (const std::filesystem::path& file : files)
        print_row(file.stem().string(), [&] { return mesh::fill(std::vector{file}, settings); });
    if (million) {
        settings.edge = 0.1;
        print_row("million", [&] { return mesh::fill(test::million_triangles(), "million", settings); });
    }
    return 0;
}
