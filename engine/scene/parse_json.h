// Strict conversion of text to a JSON document.
#pragma once

#include <filesystem>
#include <string>

#include "engine/scene/place.h"

namespace skerry {

/// Parses plain JSON (RFC 8259). Comments, trailing commas, duplicate keys and non-finite numbers are refused. Throws
/// SceneError; for a syntax error its text names line and column. `expected` describes the expected content in error
/// messages.
Json parse_json(const std::string& text, const std::filesystem::path& file,
                const std::string& expected = "a scene in JSON");

/// Reads and parses a JSON file. Throws SceneError.
Json read_json(const std::filesystem::path& file, const std::string& expected = "a scene in JSON");

}  // namespace skerry
