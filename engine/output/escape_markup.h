// Text within XML and HTML.
#pragma once

#include <string>
#include <string_view>

namespace skerry {

/// The text as it may stand in an attribute or between two tags.
std::string escape_markup(std::string_view text);

}  // namespace skerry
