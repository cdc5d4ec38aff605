// Template of the HTML page of a sweep. The build embeds sweep_page.html in the program.
#pragma once

#include <string_view>

namespace skerry {

extern const std::string_view sweep_page_html;  // template with the fields @TITLE@ and @DATA@

}  // namespace skerry
