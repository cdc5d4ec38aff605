// Writes the page as one file: the player, three.js, the summary of the run, and its frames.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "engine/output/page/page_data.h"

namespace skerry {

/// Data of the run as a whole.
struct PageSummary {
    std::string title;
    WorldReport report;
    std::uint64_t state_hash = 0;
};

/// Throws SceneError, which names `file`, if this build has no three.js.
void require_page_library(const std::filesystem::path& file);

void write_page(const std::filesystem::path& file, const PageData& data, const PageSummary& summary);

}  // namespace skerry
