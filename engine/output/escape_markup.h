// Escapes text for XML and HTML.
#pragma once

#include <string>
#include <string_view>

namespace skerry {

/// Returns the text in a form that is valid in an attribute or between two tags.
std::string escape_markup(std::string_view text);

}  // namespace skerry
