// Text and JSON about the automatic choice between explicit and implicit dynamics of bodies.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "engine/program/number_text.h"
#include "engine/scene/place.h"
#include "skerry/report.h"

namespace skerry {

/// Returns one text for each combination of chosen dynamics and reason. The text describes the first body with this
/// choice and counts the other bodies.
inline std::vector<std::string> choice_texts(const WorldReport& report) {
    std::vector<std::string> texts;
    // First choice of each kind, and number of bodies with this kind of choice.
    std::vector<std::pair<const DynamicsChoice*, std::size_t>> kinds;
    for (const DynamicsChoice& choice : report.dynamics_choices) {
        const auto same = std::find_if(kinds.begin(), kinds.end(), [&](const auto& kind) {
            return kind.first->dynamics == choice.dynamics && kind.first->estimate.reason == choice.estimate.reason;
        });
        if (same == kinds.end())
            kinds.emplace_back(&choice, 1);
        else
            ++same->second;
    }
    for (const auto& [first, count] : kinds)
        texts.push_back(first->name + (count > 1 ? " and " + grouped(count - 1) + " more bodies: " : ": ") +
                        first->message());
    return texts;
}

inline Json choices_json(const WorldReport& report) {
    Json choices = Json::array();
    for (const DynamicsChoice& choice : report.dynamics_choices) {
        const DynamicsEstimate& e = choice.estimate;
        choices.push_back({{"body", choice.name},
                           {"dynamics", name_of(choice.dynamics)},
                           {"reason", name_of(e.reason)},
                           {"explicit", {{"dt", e.explicit_step}, {"cpu_seconds_per_second", e.explicit_cost}}},
                           {"implicit",
                            {{"dt", e.implicit_step},
                             {"deforming_dt", e.deforming_step},
                             {"cpu_seconds_per_second", e.implicit_cost}}},
                           {"strain", e.strain},
                           {"damped_above_hz", e.damped_above}});
    }
    return choices;
}

}  // namespace skerry
