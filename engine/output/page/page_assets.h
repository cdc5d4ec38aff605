// The parts of the page that the build embeds (embed.cmake writes page_assets.cpp), so that an installed library needs
// no data files.
#pragma once

#include <string_view>

namespace skerry {

extern const std::string_view page_html;  // with @marks@ where the parts go
extern const std::string_view page_style;
extern const std::string_view page_script;
extern const std::string_view three_js;  // empty: the build found none

}  // namespace skerry
