#include "engine/output/table/table_page.h"

#include "engine/output/escape_markup.h"

namespace skerry {

namespace {

/// Replaces the first occurrence of `mark` in `text` by `part`.
void put_in(const std::string& mark, const std::string& part, std::string& text) {
    const std::size_t at = text.find(mark);
    if (at != std::string::npos) text.replace(at, mark.size(), part);
}

}  // namespace

std::string table_page(const std::string& title, std::string data) {
    // The text "</" would end the script element.
    for (std::size_t at = data.find("</"); at != std::string::npos; at = data.find("</", at))
        data.replace(at, 2, "<\\/");
    std::string page(table_page_html);
    // @DATA@ is replaced first. @TITLE@ comes before it in the page, so the search for @TITLE@ finds the field of the
    // page even if the data contain this text.
    put_in("@DATA@", data, page);
    put_in("@TITLE@", escape_markup(title), page);
    return page;
}

}  // namespace skerry
