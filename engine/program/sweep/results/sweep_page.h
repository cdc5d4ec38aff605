// The page of a sweep, which the build embeds (sweep_page.html).
#pragma once

#include <string_view>

namespace skerry {

extern const std::string_view sweep_page_html;  // with @TITLE@ and @DATA@ where these go

}  // namespace skerry
