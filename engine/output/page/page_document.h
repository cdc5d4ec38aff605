// Writes the HTML page as one file that contains the player, three.js, the summary of the run and its frames.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

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

void write_page(const std::filesystem::path& file, const PageData& data, const PageSummary& summary);

}  // namespace skerry
