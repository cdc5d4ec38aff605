// The command `skerry materials`: the table of named materials and their sources.
#include "skerry/materials.h"

#include <algorithm>
#include <iostream>
#include <string>
#include <string_view>
#include <vector>

#include "engine/output/json_object.h"
#include "engine/output/number_text.h"
#include "engine/program/commands.h"

namespace skerry {

namespace {

/// Numbers sources in the order of their first use.
class SourceNumbers {
public:
    std::size_t operator()(std::string_view source) {
        const auto found = std::ranges::find(sources_, source);
        if (found != sources_.end()) return static_cast<std::size_t>(found - sources_.begin()) + 1;
        sources_.push_back(source);
        return sources_.size();
    }
    const std::vector<std::string_view>& list() const { return sources_; }

private:
    std::vector<std::string_view> sources_;
};

/// Formats a value with the number of its source in brackets.
std::string sourced_text(const SourcedValue& value, const std::string& text, SourceNumbers& number) {
    return text + " [" + std::to_string(number(value.source)) + "]";
}

void print_row(std::string_view name, std::string_view modulus, std::string_view poisson, std::string_view density,
               std::string_view loss, std::string_view yield, std::string_view title) {
    const auto cell = [](std::string_view text, std::size_t width) {
        return std::string(text) + std::string(text.size() < width ? width - text.size() : 1, ' ');
    };
    std::cout << cell(name, 25) << cell(modulus, 15) << cell(poisson, 14) << cell(density, 18) << cell(loss, 13)
              << cell(yield, 15) << title << "\n";
}

void print_materials() {
    SourceNumbers number;
    print_row("material", "E", "nu", "density", "loss factor", "yield stress", "");
    for (const NamedMaterial& m : named_materials()) {
        const std::string modulus = sourced_text(m.young_modulus, with_unit(m.young_modulus.value, "Pa"), number);
        const std::string poisson = sourced_text(m.poisson_ratio, short_text(m.poisson_ratio.value), number);
        const std::string density = sourced_text(m.density, short_text(m.density.value, 4) + " kg/m^3", number);
        const std::string loss =
            m.loss_factor ? sourced_text(*m.loss_factor, short_text(m.loss_factor->value), number) : "";
        const std::string yield =
            m.yield_stress ? sourced_text(*m.yield_stress, with_unit(m.yield_stress->value, "Pa"), number) : "";
        print_row(m.name, modulus, poisson, density, loss, yield, m.title);
    }
    std::cout << "\n";
    print_row("friction of", "and", "", "static", "dynamic", "", "");
    for (const KnownFriction& pair : known_frictions())
        print_row(pair.first, pair.second, "", short_text(pair.static_friction),
                  short_text(pair.dynamic_friction) + " [" + std::to_string(number(pair.source)) + "]", "", "");
    std::cout << "\nsources\n";
    std::size_t count = 0;
    for (const std::string_view source : number.list()) std::cout << "  [" << ++count << "] " << source << "\n";
}

Json value_json(const SourcedValue& value) {
    return object_of({{"value", value.value}, {"source", value.source}});
}

}  // namespace

int materials(bool as_json) {
    if (!as_json) {
        print_materials();
        return exit_ok;
    }
    Json list = Json::array(), frictions = Json::array();
    for (const NamedMaterial& m : named_materials()) {
        Json row = object_of({{"name", m.name},
                              {"title", m.title},
                              {"young_modulus", value_json(m.young_modulus)},
                              {"poisson_ratio", value_json(m.poisson_ratio)},
                              {"density", value_json(m.density)}});
        if (m.loss_factor) row["loss_factor"] = value_json(*m.loss_factor);
        if (m.yield_stress) row["yield_stress"] = value_json(*m.yield_stress);
        list.push_back(std::move(row));
    }
    for (const KnownFriction& pair : known_frictions())
        frictions.push_back(object_of({{"first", pair.first},
                                       {"second", pair.second},
                                       {"static_friction", pair.static_friction},
                                       {"dynamic_friction", pair.dynamic_friction},
                                       {"source", pair.source}}));
    std::cout << object_of({{"materials", list}, {"frictions", frictions}}).dump(2) << "\n";
    return exit_ok;
}

}  // namespace skerry
