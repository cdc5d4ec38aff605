// Escapes the special characters of XML and HTML.
#pragma once

#include <string>
#include <string_view>

namespace skerry {

/// Returns the text in a form that is valid in the value of an attribute and between two tags.
std::string escape_markup(std::string_view text);

}  // namespace skerry
