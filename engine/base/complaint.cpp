#include "engine/base/complaint.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>
#include <vector>

namespace skerry {

std::string Complaint::text() const {
    std::string message;
    for (const std::string* part : {&file, &object, &field})
        if (!part->empty()) message += *part + ": ";
    if (!found.empty()) message += "found " + found + (expected.empty() ? "" : ", ");
    if (!expected.empty()) message += "expected " + expected;
    if (!hint.empty()) message += " (" + hint + ")";
    return message;
}

void Complaint::raise() const {
    throw SceneError(*this);
}

SceneError::SceneError(const std::string& text, Complaint complaint)
    : std::runtime_error(text), complaint_(std::make_shared<const Complaint>(std::move(complaint))) {}

void refuse(std::string_view object, std::string_view field, std::string_view found, std::string_view expected,
            std::string_view hint) {
    refuse_in({}, object, field, found, expected, hint);
}

void refuse_in(std::string_view file, std::string_view object, std::string_view field, std::string_view found,
               std::string_view expected, std::string_view hint) {
    Complaint{.file = std::string(file),
              .object = std::string(object),
              .field = std::string(field),
              .found = std::string(found),
              .expected = std::string(expected),
              .hint = std::string(hint)}
        .raise();
}

void require(bool good, std::string_view object, std::string_view field, Real found, std::string_view expected) {
    if (!good || !std::isfinite(found)) refuse(object, field, shown(found), expected);
}

void require_finite(std::string_view object, std::string_view field, const Vec3& found) {
    if (!found.allFinite()) refuse(object, field, shown(found), "three finite numbers");
}

namespace {

bool is_quote(char c) {
    return c == '"' || c == '\'';
}

/// True if `text` ends with `end`, where both kinds of quotes count as equal.
bool ends_with_name(std::string_view text, std::string_view end) {
    return text.size() >= end.size() &&
           std::ranges::equal(text.substr(text.size() - end.size()), end,
                              [](char x, char y) { return x == y || (is_quote(x) && is_quote(y)); });
}

/// True if `object` names the object at `place` again, such as in (place: object)
/// - body "ball": body 'ball'
/// - body "ball": bodies[0].pin[0]: attachment of body 'ball'
/// - cavity "tyre": cavities[0]: cavity of body 'ball'
/// - materials.rubber: material
bool is_named_by(const Complaint& place, std::string_view object) {
    if (object.empty()) return false;
    const std::string kind = place.object.substr(0, place.object.find(' ')) + " ";
    if (!place.object.empty() &&
        (ends_with_name(object, place.object) || (object.starts_with(kind) && !is_quote(object[kind.size()]))))
        return true;
    const std::string_view path = place.field;
    for (std::size_t at = path.find(object); at != path.npos; at = path.find(object, at + 1)) {
        std::string_view rest = path.substr(at + object.size());
        if (rest.starts_with('s')) rest.remove_prefix(1);  // materials contain objects of the kind material
        const auto is_limit = [](char c) { return c == '.' || c == '['; };
        if ((at == 0 || is_limit(path[at - 1])) && (rest.empty() || is_limit(rest.front()))) return true;
    }
    return false;
}

/// Removes a part and its colon from the start of a message.
void erase_part(std::string& text, const std::string& part) {
    text.erase(0, part.size() + 2);
}

}  // namespace

SceneError error_at(const Complaint& context, const SceneError& inner) {
    Complaint complaint = inner.complaint();
    std::string text = inner.what();
    const auto begins_with = [&](const std::string& part) { return !part.empty() && text.starts_with(part + ": "); };
    if (begins_with(complaint.object) && is_named_by(context, complaint.object)) {
        erase_part(text, complaint.object);
        if (begins_with(complaint.field) && context.field.ends_with("." + complaint.field)) {
            erase_part(text, complaint.field);
            complaint.field.clear();  // the field of the context replaces it
        }
    }
    if (complaint.file.empty()) {
        complaint.file = context.file;
        if (!context.object.empty()) complaint.object = context.object;
        complaint.field =
            context.field + (context.field.empty() || complaint.field.empty() ? "" : ": ") + complaint.field;
    }
    return SceneError(context.text() + text, complaint);
}

std::string short_text(Real value, int digits) {
    constexpr int written_out = 6;  // numbers with up to this many digits before the decimal point have no exponent
    char text[32];
    std::snprintf(text, sizeof text, "%.*g", digits, value);
    if (const Real rounded = std::strtod(text, nullptr); std::abs(rounded) >= 1)
        std::snprintf(text, sizeof text, "%.*g", std::max(digits, written_out), rounded);
    return text;
}

std::string short_text(const Vec3& value, int digits) {
    return "(" + short_text(value.x(), digits) + ", " + short_text(value.y(), digits) + ", " +
           short_text(value.z(), digits) + ")";
}

std::string shown(Real value) {
    return short_text(value, 6);
}

std::string shown(const Vec3& value) {
    return short_text(value, 6);
}

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

}  // namespace

std::string nearest_name(std::string_view text, std::span<const std::string> names) {
    const auto nearest = std::min_element(names.begin(), names.end(), [&](const auto& a, const auto& b) {
        return edit_distance(text, a) < edit_distance(text, b);
    });
    return nearest == names.end() ? std::string() : *nearest;
}

std::string nearest_hint(std::string_view text, std::span<const std::string> names) {
    const std::string nearest = nearest_name(text, names);
    // A name is suggested if at most one letter differs, or at most one in three letters (letters_per_slip). With more
    // differences the text is probably another word, not a typing mistake.
    constexpr std::size_t letters_per_slip = 3;
    const std::size_t most = std::max<std::size_t>(1, std::max(text.size(), nearest.size()) / letters_per_slip);
    return nearest.empty() || edit_distance(text, nearest) > most ? std::string() : "did you mean \"" + nearest + "\"?";
}

void expect_offsets(std::span<const Index> offset, std::size_t items,
                    FunctionRef<void(const std::string& found, const std::string& expected)> complain) {
    const auto most = static_cast<Index>(items);
    for (std::size_t i = 0; i < offset.size(); ++i) {
        const Index least = i == 0 ? 0 : offset[i - 1];
        if (offset[i] >= least && offset[i] <= most && (i > 0 || offset[i] == 0)) continue;
        const std::string found = std::to_string(offset[i]) + " at entry " + std::to_string(i);
        if (i == 0) complain(found, "0, the first offset");
        if (offset[i] > most) complain(found, "an offset <= " + std::to_string(most) + ", the number of items");
        complain(found, "an offset >= " + std::to_string(least) + ", because offsets ascend");
    }
}

}  // namespace skerry
