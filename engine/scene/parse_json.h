// Text to JSON, strictly.
#pragma once

#include <filesystem>
#include <string>

#include "engine/scene/place.h"

namespace skerry {

/// Parses plain JSON (RFC 8259): comments, trailing commas, keys given twice and numbers that are not finite are
/// refused. Throws SceneError with line and column.
Json parse_json(const std::string& text, const std::filesystem::path& file);

/// Reads and parses a file. Throws SceneError.
Json read_json(const std::filesystem::path& file);

}  // namespace skerry
