// A web page with a table of runs and a plot of any number against any other, for sweeps and studies.
#pragma once

#include <string>
#include <string_view>

namespace skerry {

extern const std::string_view table_page_html;  // template with the fields @TITLE@ and @DATA@

/// Returns the page as one file that needs no other files. `data` is JSON text; the head of the script in
/// table_page.html lists its keys.
std::string table_page(const std::string& title, std::string data);

}  // namespace skerry
