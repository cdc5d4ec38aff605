#include "engine/scene/parse_json.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <fstream>
#include <sstream>

namespace skerry {

namespace {

/// Writes bytes above ASCII as \xNN, because text cited in a message may be invalid UTF-8.
std::string printable(const std::string& text) {
    std::string result;
    for (const char c : text) {
        char code[8];
        std::snprintf(code, sizeof code, "\\x%02x", static_cast<unsigned>(static_cast<unsigned char>(c)));
        result += static_cast<unsigned char>(c) < 0x80 ? std::string(1, c) : std::string(code);
    }
    return result;
}

/// Builds the JSON document from parser events. Refuses duplicate keys, which the builder of the nlohmann library
/// accepts.
class StrictBuilder : public nlohmann::json_sax<Json> {
public:
    StrictBuilder(const std::string& text, const std::filesystem::path& file) : text_(text), file_(file) {}

    Json take() { return std::move(root_); }

    bool null() override { return put(Json()), true; }
    bool boolean(bool value) override { return put(value), true; }
    bool number_integer(number_integer_t value) override { return put(value), true; }
    bool number_unsigned(number_unsigned_t value) override { return put(value), true; }
    bool number_float(number_float_t value, const string_t&) override { return put(value), true; }
    bool string(string_t& value) override { return put(std::move(value)), true; }
    bool binary(binary_t&) override { return false; }  // cannot occur, because JSON text has no binary values
    bool start_object(std::size_t) override { return open(Json::object()); }
    bool end_object() override { return close(); }
    bool start_array(std::size_t) override { return open(Json::array()); }
    bool end_array() override { return close(); }

    bool key(string_t& name) override {
        open_.back().key = name;
        if (open_.back().value->contains(name))
            here().refuse("the key " + in_quotes(name) + " twice in the same object", "every key at most once",
                          "delete one of the two");
        return true;
    }

    bool parse_error(std::size_t position, const std::string& token, const Json::exception& error) override {
        const std::string what = error.what();
        if (error.id == out_of_range_id)
            here().refuse("the number " + token, "a number within the range of double precision");
        std::string hint;
        if (token.find('/') != std::string::npos || token.find('#') != std::string::npos)
            hint = "JSON has no comments; delete the comment or use a \"description\" key";
        else if (token.find("N") == token.size() - 1 || token.find("nan") != std::string::npos ||
                 token.find("I") == token.size() - 1)
            hint = "JSON has no NaN and no Infinity; write a finite number";
        refuse_in(file_.string(), line_and_column(position), {},
                  "text that is not valid JSON: " + printable(reason(what)), {}, hint);
    }

private:
    static constexpr int out_of_range_id = 406;  // nlohmann's "number overflow"

    struct Open {
        Json* value;
        std::string key;
    };

    Place here() const {
        Place place(file_);
        for (std::size_t i = 0; i < open_.size(); ++i) {
            const Open& level = open_[i];
            // A list or object that is still being read is already an item of the list around it: the last one, with
            // the index size() - 1. If none is open inside of this list, the next item will have the index size().
            const std::size_t begun = i + 1 < open_.size() ? 1 : 0;
            if (level.value->is_array())
                place = place.item(level.value->size() - begun);
            else if (!level.key.empty())
                place = place.key(level.key);
        }
        return place;
    }

    Json* put(Json value) {
        if (open_.empty()) return &(root_ = std::move(value));
        Json& parent = *open_.back().value;
        if (parent.is_array()) return &parent.emplace_back(std::move(value));
        Json& slot = parent[open_.back().key];
        slot = std::move(value);
        return &slot;
    }

    bool open(Json value) {
        // A scene needs fewer than ten levels of nesting. The limit protects recursive functions from a stack overflow
        // on a file full of brackets.
        constexpr std::size_t deepest = 100;
        if (open_.size() == deepest)
            Place(file_).refuse("lists and objects nested more than " + std::to_string(deepest) + " deep",
                                "a file with fewer levels");
        open_.push_back({put(std::move(value)), {}});
        return true;
    }

    bool close() {
        open_.pop_back();
        return true;
    }

    std::string line_and_column(std::size_t position) const {
        const std::size_t end = std::min(position == 0 ? 0 : position - 1, text_.size());
        const auto first = text_.begin();
        const auto last = first + static_cast<std::ptrdiff_t>(end);
        const auto lines = std::count(first, last, '\n');
        const std::size_t line_start = text_.rfind('\n', end == 0 ? 0 : end - 1);
        const std::size_t column = lines == 0 || line_start == std::string::npos ? end + 1 : end - line_start;
        return "line " + std::to_string(lines + 1) + ", column " + std::to_string(column);
    }

    /// Returns the error message of the library without its prefix and position.
    static std::string reason(const std::string& what) {
        const std::size_t start = what.find(": ");
        return start == std::string::npos ? what : what.substr(start + 2);
    }

    const std::string& text_;
    std::filesystem::path file_;
    Json root_;
    std::vector<Open> open_;
};

}  // namespace

Json parse_json(const std::string& text, const std::filesystem::path& file, const std::string& expected) {
    if (std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isspace(c); }))
        refuse_in(file.string(), {}, {}, "an empty file", expected);
    StrictBuilder builder(text, file);
    Json::sax_parse(text, &builder);
    return builder.take();
}

Json read_json(const std::filesystem::path& file, const std::string& expected) {
    std::error_code error;
    if (!std::filesystem::exists(file, error))
        refuse_in(file.string(), {}, {}, "no such file", expected, "check the path");
    if (std::filesystem::is_directory(file, error))
        refuse_in(file.string(), {}, {}, "a folder", expected, "give the path of a file");
    // Refuses devices such as /dev/zero, which are endless. Pipes are allowed, because they end.
    if (std::filesystem::is_character_file(file, error))
        refuse_in(file.string(), {}, {}, "a device", expected, "give the path of a file");
    std::ifstream stream(file, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    if (!stream)
        refuse_in(file.string(), {}, {}, "a file that cannot be opened or read", expected,
                  "check the permissions of the file");
    return parse_json(text.str(), file, expected);
}

}  // namespace skerry
