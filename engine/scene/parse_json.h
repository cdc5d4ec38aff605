// Text to JSON, strictly.
#pragma once

#include <filesystem>
#include <string>

#include "engine/scene/place.h"

namespace skerry {

/// Parses plain JSON (RFC 8259): comments, trailing commas, keys given twice and numbers that are not finite are
/// refused. Throws SceneError with line and column; `expected` is what the file is to be, for messages.
Json parse_json(const std::string& text, const std::filesystem::path& file,
                const std::string& expected = "a scene in JSON");

/// Reads and parses a file. Throws SceneError.
Json read_json(const std::filesystem::path& file, const std::string& expected = "a scene in JSON");

}  // namespace skerry
