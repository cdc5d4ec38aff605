// Parts of the HTML page. The build embeds them in the library (embed.cmake writes page_assets.cpp), so that an
// installed library needs no data files.
#pragma once

#include <string_view>

namespace skerry {

extern const std::string_view page_html;  // page template; marks such as @style@ are replaced by parts of the page
extern const std::string_view page_style;
extern const std::string_view page_script;
extern const std::string_view three_js;  // three.js in the gzip format; empty if the build did not find it

}  // namespace skerry
