// The HTML page: one text that contains the player and three.js, and for a recorded run its summary and its frames.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include "engine/output/json_object.h"
#include "engine/output/page/page_data.h"

namespace skerry {

/// Data of the page that do not belong to a frame.
struct PageSummary {
    std::string title;
    WorldReport report;
    std::uint64_t state_hash = 0;
};

/// Throws SceneError if this build has no three.js. The message names `file`.
void require_page_library(const std::filesystem::path& file);

/// Returns a page without a run. When it is open in a browser, it requests a live stream from its server. Throws
/// SceneError if this build has no three.js.
std::string live_page();

/// Numbers of bodies and other objects in a stream, or in the part of a stream that a page already has.
struct PageCounts {
    std::size_t bodies = 0, visuals = 0, colliders = 0, lines = 0;

    bool operator==(const PageCounts&) const = default;
};
PageCounts counts_of(const PageStream& stream);
/// Returns the JSON members that describe the objects of a stream. `first`: number of objects of each kind that are
/// left out, because the page already has them.
Json json_of_objects(const PageStream& stream, const PageCounts& first);
/// Returns the values of a frame for the plots, by name.
Json json_of_row(const PageRow& row);
/// Returns JSON as text. Names come from users and may contain any bytes. Bytes that are not UTF-8 become U+FFFD.
std::string text_of(const Json& json);

void write_page(const std::filesystem::path& file, const PageData& data, const PageSummary& summary);

}  // namespace skerry
