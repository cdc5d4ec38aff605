// Page of a sweep, embedded by the build (sweep_page.html).
#pragma once

#include <string_view>

namespace skerry {

extern const std::string_view sweep_page_html;  // contains the placeholders @TITLE@ and @DATA@

}  // namespace skerry
