// Interface of the outputs of a run, and the writers that implement it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>

#include "skerry/scene.h"

namespace skerry {

/// The state of a run when its outputs are opened.
struct RunStart {
    double step_count = 0;   // estimate of the number of steps to come
    std::size_t frames = 0;  // number of frames that earlier parts of the run have written; 0: a new run
    Real frame_step = 0;     // time between two frames [s]

    bool resumed() const { return frames > 0; }
};

/// One output of a run. All functions may throw. An exception of the constructor or of open() refuses the run; an
/// exception of any other function ends this output, and the run goes on. The constructor must not create files.
class Writer {
public:
    virtual ~Writer() = default;

    /// True if this output may write a file of this name, which then cannot be used for anything else.
    virtual bool may_write(const std::filesystem::path&) const { return false; }
    /// Begins or, for a resumed run, continues the output. Called once, before the first step.
    virtual void open(World&, const RunStart&) {}
    /// Called after every call of World::advance.
    virtual void sample(const World&) {}
    /// Called at the end of every frame, and for a new run also before the first step.
    virtual void add_frame(const World&) {}
    /// Completes the files. Called once, after the last step.
    virtual void close(const World&) {}
    /// Wall time that this output has spent within calls of World::advance [s].
    virtual double seconds_in_steps() const { return 0; }
    /// The written files, as a text for the user, such as "page.html (open it in a browser)".
    virtual std::string written() const = 0;
};

/// Writes a series of frames for ParaView into a folder.
std::unique_ptr<Writer> paraview_frames(const std::filesystem::path& folder, const Scene& scene);
/// Writes one HTML page that plays the run. For a resumed run it begins at the checkpoint.
std::unique_ptr<Writer> html_page(const std::filesystem::path& file, const Scene& scene);
/// Writes the time series of the scene's probes: CSV row by row, or HDF5 at the end, as the extension of the file says.
/// Throws SceneError for any other extension, and for a scene without probes that have a series.
std::unique_ptr<Writer> probe_series(const std::filesystem::path& file, const Scene& scene);
/// Writes the work of all threads as a trace for Perfetto.
std::unique_ptr<Writer> thread_trace(const std::filesystem::path& file);

}  // namespace skerry
