// Messages that a live view sends to a browser, as JSON texts (docs/decisions/0028-live-view.md).
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/live/snapshot.h"
#include "engine/output/page/page_document.h"
#include "skerry/recorder.h"
#include "skerry/slider.h"

namespace skerry {

/// State of the controls on the page that the user can change.
struct LiveState {
    bool playing = true;
    Real rate = 1;        // simulated time per wall time; 0: as fast as possible
    bool gravity = true;  // false if gravity is switched off

    bool operator==(const LiveState&) const = default;
};

/// Columns of the plot of one probe.
struct LivePlot {
    std::string name;
    std::vector<SeriesColumn> columns;
};

/// Data of a run that a browser gets in the first message of a stream.
struct LiveRunInfo {
    std::string title;
    Vec3 gravity = Vec3::Zero();  // [m/s^2]
    std::vector<Slider> sliders;
    std::vector<Real> slider_values;
    std::vector<LivePlot> plots;
};

/// First message of a stream. The browser then discards all objects, and decodes the next frame as the first one.
std::string begin_text(const LiveRunInfo& info, const LiveState& state);
std::string state_text(const LiveState& state);
/// Reports a refused command, or a failed step.
std::string problem_text(const std::string& problem);

/// Encodes the snapshots for one browser. Its memory does not grow with the number of frames, but with the number of
/// objects that were in any frame of the stream.
class LiveEncoder {
public:
    /// Messages of one frame, in the order in which they are sent. `changes` is valid until the next call of pack().
    struct Messages {
        std::string added;         // objects that are new in this frame; empty if there are none
        std::string row;           // values for plots and legends
        std::string_view changes;  // bytes of PageStream::pack
    };
    /// `frame`: number of the frame among those sent to this browser, from 1. `client`: number of the browser.
    Messages pack(const Snapshot& snapshot, std::uint64_t frame, std::uint64_t client);
    /// True if most objects of the stream, and more than 1000, are no longer in the world. A new stream then saves
    /// memory here and on the page.
    bool is_outgrown(const Snapshot& snapshot) const;
    /// Handles of the bodies, in the order in which the stream numbers them.
    std::span<const BodyHandle> bodies() const { return stream_.body_handles(); }

private:
    std::string row_text(const Snapshot& snapshot, std::uint64_t frame, std::uint64_t client);
    Real legend_top(std::size_t field);
    Real legend_top();

    PageStream stream_;
    PageCounts known_;
    std::vector<Real> values_;  // working memory
};

}  // namespace skerry
