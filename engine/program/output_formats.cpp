#include "engine/program/output_formats.h"

#include "engine/program/problem_export.h"

namespace skerry {

std::span<const OutputFormat> output_formats() {
    using Request = const OutputRequest&;
    static constexpr OutputFormat formats[] = {
        {"--out", "folder for frames for ParaView (open SCENE.pvd); frames of an earlier run are replaced", true,
         [](Request request) { return paraview_frames(request.path, request.scene); }},
        {"--page", "HTML file that plays the run in a browser, without a network connection", false,
         [](Request request) { return html_page(request.path, request.scene); }},
        {"--film", "USD file (.usd, .usdc) that plays the run in Blender and other programs", false,
         [](Request request) { return usd_film(request.path, request.options.film_color, request.options.film_max); }},
        {"--gltf", "glTF file (.glb) of the state at the end of the run", false,
         [](Request request) {
             return gltf_state(request.path, request.options.film_color, request.options.film_max);
         }},
        {"--probes",
         "file for the time series of the scene's probes: .csv is written row by row, .h5 and .hdf5 at the end of the "
         "run",
         false, [](Request request) { return probe_series(request.path, request.scene); }},
        {"--trace", "file for a trace of all threads, for Perfetto or chrome://tracing", false,
         [](Request request) { return thread_trace(request.path); }},
        {"--export-problems",
         "folder for contact problems of single steps, as local problems in FCLIB's HDF5 format; those "
         "of an earlier run are replaced",
         true, [](Request request) { return exported_problems(request.path, request.scene, request.options); }},
        {"--stats", "JSON file for all statistics of the run", false,
         [](Request request) { return statistics_file(request.path, request.result); }},
    };
    return formats;
}

}  // namespace skerry
