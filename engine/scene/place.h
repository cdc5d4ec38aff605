// Where in a scene file something stands, and complaints about it.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "skerry/error.h"

namespace skerry {

/// Keeps the order of keys: that of a file when reading, that of the tables in the schema.
using Json = nlohmann::ordered_json;

/// A place in a file, written like bodies[3].mesh.ball, and the named object it belongs to.
class Place {
public:
    Place() = default;
    explicit Place(std::filesystem::path file) : file_(std::move(file)) {}

    Place key(std::string_view name) const;
    Place item(std::size_t index) const;
    /// The same place, said to belong to an object such as: body "ball".
    Place of(std::string object) const;

    const std::filesystem::path& file() const { return file_; }
    const std::string& path() const { return path_; }
    [[noreturn]] void refuse(std::string found, std::string expected, std::string hint = {}) const;
    /// Says what went wrong further inside, where files and keys are not known.
    [[noreturn]] void refuse_inner(const std::string& message) const;

private:
    std::filesystem::path file_;
    std::string path_;
    std::string object_;
};

/// Calls function() and says of what it complains about where that stands.
template <class Function>
auto called_at(const Place& place, Function function) {
    try {
        return function();
    } catch (const SceneError& error) {
        place.refuse_inner(error.what());
    } catch (const std::invalid_argument& error) {
        place.refuse_inner(error.what());
    }
}

std::string in_quotes(std::string_view text);
/// "a", "b", "c"
std::string listed(std::span<const std::string> names);
/// A value as a message calls it: the text "x", the number 3, a list of 2 values, ...
std::string described(const Json& value);
/// The name that `text` was probably meant to be: the fewest changed, missing, added or swapped letters. Empty without
/// names.
std::string nearest_name(std::string_view text, std::span<const std::string> names);
/// A hint with the nearest name, or nothing when none is near: more than a third of the letters are others.
std::string nearest_hint(std::string_view text, std::span<const std::string> names);

}  // namespace skerry
