#include "engine/scene/place.h"

#include <algorithm>
#include <cctype>

#include "engine/world/complaint.h"

namespace skerry {

namespace {

/// Optimal string alignment distance: Levenshtein distance in which two swapped letters count as one change.
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::vector<std::size_t>> cost(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
    for (std::size_t i = 0; i <= a.size(); ++i) cost[i][0] = i;
    for (std::size_t j = 0; j <= b.size(); ++j) cost[0][j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i)
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const auto same = [](char x, char y) {
                return std::tolower(static_cast<unsigned char>(x)) == std::tolower(static_cast<unsigned char>(y));
            };
            cost[i][j] = std::min(
                {cost[i - 1][j] + 1, cost[i][j - 1] + 1, cost[i - 1][j - 1] + (same(a[i - 1], b[j - 1]) ? 0u : 1u)});
            if (i > 1 && j > 1 && same(a[i - 1], b[j - 2]) && same(a[i - 2], b[j - 1]))
                cost[i][j] = std::min(cost[i][j], cost[i - 2][j - 2] + 1);
        }
    return cost[a.size()][b.size()];
}

bool is_plain_name(std::string_view name) {
    return !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-';
    });
}

}  // namespace

Place Place::key(std::string_view name) const {
    Place inner = *this;
    if (is_plain_name(name))
        inner.path_ += (path_.empty() ? "" : ".") + std::string(name);
    else
        inner.path_ += "[" + in_quotes(name) + "]";
    return inner;
}

Place Place::item(std::size_t index) const {
    Place inner = *this;
    inner.path_ += "[" + std::to_string(index) + "]";
    return inner;
}

Place Place::of(std::string object) const {
    Place same = *this;
    same.object_ = std::move(object);
    return same;
}

void Place::refuse(std::string found, std::string expected, std::string hint) const {
    Complaint{file_.string(), object_, path_, std::move(found), std::move(expected), std::move(hint)}.raise();
}

void Place::refuse_inner(const SceneError& inner) const {
    throw error_at({file_.string(), object_, path_, {}, {}, {}}, inner);
}

std::string in_quotes(std::string_view text) {
    return Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string listed(std::span<const std::string> names) {
    std::string list;
    for (const std::string& name : names) list += (list.empty() ? "" : ", ") + in_quotes(name);
    return list;
}

std::string described(const Json& value) {
    constexpr std::size_t longest = 60;  // longest value that is repeated in an error message [characters]
    const std::string text = value.dump(-1, ' ', false, Json::error_handler_t::replace);
    if (value.is_object())
        return text.size() <= longest ? "the object " + text
                                      : "an object with " + std::to_string(value.size()) + " keys";
    if (value.is_array())
        return text.size() <= longest ? "the list " + text : "a list of " + std::to_string(value.size()) + " values";
    const std::string shown = text.size() <= longest ? text : text.substr(0, longest) + "...";
    if (value.is_string()) return "the text " + shown;
    if (value.is_number()) return "the number " + shown;
    return shown;
}

std::string nearest_name(std::string_view text, std::span<const std::string> names) {
    const auto nearest = std::min_element(names.begin(), names.end(), [&](const auto& a, const auto& b) {
        return edit_distance(text, a) < edit_distance(text, b);
    });
    return nearest == names.end() ? std::string() : *nearest;
}

std::string nearest_hint(std::string_view text, std::span<const std::string> names) {
    const std::string nearest = nearest_name(text, names);
    // A name is suggested if at most one in this number of letters differs. With more differences the text is probably
    // another word, not a typing mistake.
    constexpr std::size_t letters_per_slip = 3;
    const std::size_t most = std::max<std::size_t>(1, std::max(text.size(), nearest.size()) / letters_per_slip);
    return nearest.empty() || edit_distance(text, nearest) > most ? std::string()
                                                                  : "did you mean " + in_quotes(nearest) + "?";
}

}  // namespace skerry
