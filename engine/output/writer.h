// Interface of the outputs of a run, and functions that create these outputs.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "skerry/output.h"
#include "skerry/scene.h"

namespace skerry {

/// State of a run at the moment when its outputs are opened.
struct RunStart {
    double step_count = 0;   // estimated number of remaining steps
    std::size_t frames = 0;  // number of frames written so far if the run is resumed; 0 for a new run
    Real frame_step = 0;     // time between two frames [s]
    Real row_step = 0;       // time between two rows of a series [s]; 0: every call of Writer::sample makes a row

    bool resumed() const { return frames > 0; }
};

/// One output of a run. All functions may throw, with these effects:
/// - the constructor or open(): the run does not start,
/// - sample(), add_frame() or close(): only this output ends. The run continues unless all of its outputs have ended.
///
/// The constructor must not create files, because the run may still be refused.
class Writer {
public:
    virtual ~Writer() = default;

    /// True if this output may write a file with this path. No other output may then write this path, and no input may
    /// be read from it.
    virtual bool may_write(const std::filesystem::path&) const { return false; }
    /// Starts the output, or continues it if the run is resumed. Called once, before the first step.
    virtual void open(World&, const RunStart&) {}
    /// Called after every call of World::advance.
    virtual void sample(const World&) {}
    /// Called at the end of every frame. For a new run it is also called before the first step.
    virtual void add_frame(const World&) {}
    /// Completes the files of the output. Called once, after the last step.
    virtual void close(const World&) {}
    /// Wall time that callbacks of the output have taken inside World::advance [s]. The run reports it as time of the
    /// outputs, not of the simulation.
    virtual double seconds_in_steps() const { return 0; }
    /// Description of the written files for the user, for example "page.html (open it in a browser)".
    virtual std::string written() const = 0;
};

/// Output of frames for ParaView to a folder.
std::unique_ptr<Writer> paraview_frames(const std::filesystem::path& folder, const Scene& scene);
/// Output of one HTML page that plays the run. For a resumed run the page begins at the checkpoint.
std::unique_ptr<Writer> html_page(const std::filesystem::path& file, const Scene& scene);
/// Output of the time series of the scene's probes. The extension of the file selects the format: CSV, written row by
/// row, or HDF5, written at the end. Throws SceneError for any other extension, and if no probe of the scene has a
/// series.
std::unique_ptr<Writer> probe_series(const std::filesystem::path& file, const Scene& scene);
/// Output of a film. For a resumed run the film begins at the checkpoint. Throws SceneError unless the extension of the
/// file is .usd or .usdc.
std::unique_ptr<Writer> usd_film(const std::filesystem::path& file, FilmColor color, std::optional<Real> color_max);
/// Output of a glTF file with the state at the end of the run. Throws SceneError unless the extension of the file is
/// .glb. Also throws if glTF is not built in.
std::unique_ptr<Writer> gltf_state(const std::filesystem::path& file, FilmColor color, std::optional<Real> color_max);
/// Output of a trace of the activities of all threads, for Perfetto.
std::unique_ptr<Writer> thread_trace(const std::filesystem::path& file);

}  // namespace skerry
