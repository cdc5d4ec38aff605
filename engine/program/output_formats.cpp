#include "engine/program/output_formats.h"

#include "engine/program/problem_export.h"

namespace skerry {

std::span<const OutputFormat> output_formats() {
    using Request = const OutputRequest&;
    static constexpr OutputFormat formats[] = {
        {"--out", "folder for frames for ParaView (open SCENE.pvd); frames of an earlier run are replaced", true,
         [](Request of) { return paraview_frames(of.place, of.scene); }},
        {"--page", "HTML file that plays the run in a browser, without a network connection", false,
         [](Request of) { return html_page(of.place, of.scene); }},
        {"--film", "USD file (.usd, .usdc) that plays the run in Blender and other programs", false,
         [](Request of) { return usd_film(of.place, of.options.film_color, of.options.film_max); }},
        {"--gltf", "glTF file (.glb) of the state at the end of the run", false,
         [](Request of) { return gltf_state(of.place, of.options.film_color, of.options.film_max); }},
        {"--probes",
         "file for the time series of the scene's probes: .csv is written row by row, .h5 and .hdf5 at the end of the "
         "run",
         false, [](Request of) { return probe_series(of.place, of.scene); }},
        {"--trace", "file for a trace of all threads, for Perfetto or chrome://tracing", false,
         [](Request of) { return thread_trace(of.place); }},
        {"--export-problems", "folder for contact problems of single steps, as local problems in FCLIB's HDF5 format",
         true, [](Request of) { return exported_problems(of.place, of.scene, of.options); }},
        {"--stats", "JSON file for all statistics of the run", false,
         [](Request of) { return statistics_file(of.place, of.result); }},
    };
    return formats;
}

}  // namespace skerry
