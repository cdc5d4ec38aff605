// Locations in a scene file, and error messages about them.
#pragma once

#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/complaint.h"
#include "engine/output/json_object.h"
#include "skerry/error.h"

namespace skerry {

/// A location in a scene file, written like bodies[3].mesh.ball, and the name of the object to which it belongs.
class Place {
public:
    Place() = default;
    explicit Place(const std::filesystem::path& file) : Place(file, file.parent_path()) {}
    /// `folder`: folder in which relative paths in the file start.
    Place(std::filesystem::path file, std::filesystem::path folder)
        : file_(std::move(file)), folder_(std::move(folder)) {}

    Place key(std::string_view name) const;
    Place item(std::size_t index) const;
    /// Returns this location together with the name of its object for error messages, such as: body "ball".
    Place of(std::string object) const;

    const std::filesystem::path& file() const { return file_; }
    const std::filesystem::path& folder() const { return folder_; }
    const std::string& path() const { return path_; }
    [[noreturn]] void refuse(std::string found, std::string expected, std::string hint = {}) const;
    /// Throws the error `inner` again, with this location in front. For errors of functions that know neither the file
    /// nor the key.
    [[noreturn]] void refuse_inner(const SceneError& inner) const;

private:
    std::filesystem::path file_, folder_;
    std::string path_;
    std::string object_;
};

/// Calls function() and adds the location in the file to its error messages.
template <class Function>
auto called_at(const Place& place, Function function) {
    try {
        return function();
    } catch (const SceneError& error) {
        place.refuse_inner(error);
    } catch (const std::invalid_argument& error) {
        place.refuse_inner(SceneError(error.what()));
    }
}

std::string in_quotes(std::string_view text);
/// Returns the names in quotes and separated by commas: "a", "b", "c".
std::string listed(std::span<const std::string> names);
/// Describes a JSON value for error messages: the text "x", the number 3, a list of 2 values, ...
std::string described(const Json& value);

}  // namespace skerry
