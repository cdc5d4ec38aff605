// Parts of the page, embedded by the build (embed.cmake writes page_assets.cpp), so that an installed library needs no
// data files.
#pragma once

#include <string_view>

namespace skerry {

extern const std::string_view page_html;  // contains @marks@ as placeholders for the parts
extern const std::string_view page_style;
extern const std::string_view page_script;
extern const std::string_view three_js;  // empty: not found by the build

}  // namespace skerry
