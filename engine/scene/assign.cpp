#include "engine/scene/assign.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <string_view>
#include <utility>
#include <vector>

namespace skerry {

namespace {

/// One component of a path such as bodies[0].position: a key of an object, or the index of a list item.
struct Step {
    std::string key;
    std::size_t item = 0;
    bool is_item = false;
};

class Assignment {
public:
    Assignment(const std::string& text, const std::filesystem::path& file) : text_(text), file_(file) {
        const std::size_t end = end_of_place();
        place_ = std::string_view(text_).substr(0, end);
        value_ = text_.substr(end + 1);
    }

    void carry_out(Json& scene) {
        if (place_.empty()) refuse("no place before \"=\"", "a place in the scene before \"=\"");
        refuse_new_material(scene);
        Json* at = &scene;
        while (!place_.empty()) at = &inner(*at, next_step());
        Json value = Json::parse(value_, nullptr, false);
        *at = value.is_discarded() ? Json(value_) : std::move(value);
    }

private:
    [[noreturn]] void refuse(const std::string& found, const std::string& expected,
                             const std::string& hint = "write PLACE=VALUE, such as bodies[0].position=[0,0,1]") const {
        refuse_in(file_.string(), in_quotes(text_), {}, found, expected, hint);
    }

    /// Refuses a place inside a material that the scene lacks: a misspelt name would create a material that no body
    /// uses.
    void refuse_new_material(const Json& scene) const {
        Assignment rest = *this;
        if (rest.next_step().key != "materials" || rest.place_.empty()) return;
        const std::string name = rest.next_step().key;
        std::vector<std::string> known;
        if (const auto found = scene.find("materials"); found != scene.end() && found->is_object())
            for (const auto& [key, value] : found->items()) known.push_back(key);
        if (rest.place_.empty() || name.empty() || std::ranges::find(known, name) != known.end()) return;
        refuse("a place in the unknown material " + in_quotes(name),
               known.empty() ? "a scene that defines materials" : "a place in one of the materials " + listed(known),
               nearest_hint(name, known));
    }

    /// Returns the index in the text of the first "=" outside of quotes.
    std::size_t end_of_place() const {
        bool quoted = false;
        for (std::size_t i = 0; i < text_.size(); ++i) {
            quoted ^= text_[i] == '"';
            if (text_[i] == '=' && !quoted) return i;
        }
        refuse("no \"=\"", "a place, \"=\" and a value");
    }

    /// Removes the next component from the unprocessed part of the path, and returns the component.
    Step next_step() {
        if (place_.front() == '.') place_.remove_prefix(1);
        if (!place_.empty() && place_.front() == '[') return next_in_brackets();
        const std::size_t end = std::min(place_.find_first_of(".["), place_.size());
        if (end == 0)
            refuse(place_.empty() ? "no key after \".\"" : "no key before " + in_quotes(place_), "the name of a key");
        Step step{std::string(place_.substr(0, end))};
        place_.remove_prefix(end);
        return step;
    }
    Step next_in_brackets() {
        Step step;
        place_.remove_prefix(1);
        const bool quoted = !place_.empty() && place_.front() == '"';
        const std::size_t end = place_.find(quoted ? "\"]" : "]", quoted ? 1 : 0);
        if (end == std::string_view::npos) refuse("a \"[\" that is not closed", "[NUMBER] or [\"NAME\"]");
        if (quoted) {
            step.key = std::string(place_.substr(1, end - 1));
        } else {
            step.is_item = true;
            const char* const last = place_.data() + end;
            const auto [read, error] = std::from_chars(place_.data(), last, step.item);
            if (error != std::errc() || read != last || end == 0)
                refuse("the index " + in_quotes(place_.substr(0, end)), "a whole number of at least 0");
        }
        place_.remove_prefix(end + (quoted ? 2 : 1));
        return step;
    }

    Json& inner(Json& of, const Step& step) const {
        if (!step.is_item) {
            if (of.is_null()) of = Json::object();
            if (!of.is_object())
                refuse(described(of) + " as the parent of the key " + in_quotes(step.key), "an object");
            return of[step.key];
        }
        if (!of.is_array())
            refuse(of.is_null() ? "no value" : described(of), "a list, because the place continues with an index");
        if (step.item >= of.size())
            refuse("index " + std::to_string(step.item) + " in a list of length " + std::to_string(of.size()),
                   of.empty() ? "a list that is not empty" : "an index from 0 to " + std::to_string(of.size() - 1));
        return of[step.item];
    }

    const std::string& text_;
    const std::filesystem::path& file_;
    std::string_view place_;  // part of the path that next_step() has not removed yet
    std::string value_;
};

}  // namespace

void assign(const std::string& assignment, const std::filesystem::path& file, Json& scene) {
    Assignment(assignment, file).carry_out(scene);
}

}  // namespace skerry
