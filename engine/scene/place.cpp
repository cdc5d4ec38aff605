#include "engine/scene/place.h"

#include <algorithm>
#include <cctype>

namespace skerry {

namespace {

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
    refuse_in(file_.string(), object_, path_, found, expected, hint);
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

}  // namespace skerry
