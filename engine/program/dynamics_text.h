// Text and JSON about the automatic choice between explicit and implicit dynamics of bodies.
#pragma once

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "engine/output/number_text.h"
#include "engine/scene/place.h"
#include "skerry/report.h"

namespace skerry {

/// Returns one text for each combination of chosen dynamics and reason. The text describes the first body with this
/// combination and counts the other bodies that have it.
inline std::vector<std::string> choice_texts(const WorldReport& report) {
    std::vector<std::string> texts;
    // First choice with each combination of dynamics and reason, and number of bodies with this combination.
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
        texts.push_back(
            first->name +
            (count > 1 ? " and " + grouped(count - 1) + (count == 2 ? " more body: " : " more bodies: ") : ": ") +
            first->message());
    return texts;
}

/// Returns one sentence about all choices, such as "30 bodies: 27 implicit (stiff: explicit steps would cost 8.8 times
/// as much), 3 explicit (soft: strains of up to 44 % expected)". Empty if there are no choices.
inline std::string choices_text(const WorldReport& report) {
    struct Kind {
        std::size_t bodies = 0;
        Real explicit_cost = 0, implicit_cost = 0, strain = 0;
    };
    std::map<std::pair<BodyDynamics, DynamicsReason>, Kind> kinds;
    for (const auto& [body, name, dynamics, estimate] : report.dynamics_choices) {
        Kind& kind = kinds[{dynamics, estimate.reason}];
        ++kind.bodies;
        kind.explicit_cost += estimate.explicit_cost;
        kind.implicit_cost += estimate.implicit_cost;
        kind.strain = std::max(kind.strain, estimate.strain);
    }
    const auto why = [](BodyDynamics dynamics, DynamicsReason reason, const Kind& kind) -> std::string {
        constexpr Real written_out = 100;  // larger ratios are written without a decimal point or exponent
        const auto times = [](Real a, Real b) {
            return (a < written_out * b ? short_text(a / b, 2) : count_text(a / b)) + " times as much";
        };
        if (reason == DynamicsReason::self_contact) return "self-contact";
        if (reason == DynamicsReason::losses) return "loss_factor";
        if (reason == DynamicsReason::plasticity) return "plasticity";
        if (reason == DynamicsReason::strain) return "soft: strains of up to " + percent(kind.strain) + " expected";
        if (dynamics == BodyDynamics::implicit_elastic)
            return "stiff: explicit steps would cost " + times(kind.explicit_cost, kind.implicit_cost);
        return "implicit steps would cost " + times(kind.implicit_cost, kind.explicit_cost);
    };
    std::string text;
    for (const auto& [key, kind] : kinds)
        text += (text.empty() ? "" : ", ") + grouped(kind.bodies) + " " + std::string(name_of(key.first)) + " (" +
                why(key.first, key.second, kind) + ")";
    const std::size_t bodies = report.dynamics_choices.size();
    return bodies == 0 ? text : grouped(bodies) + (bodies == 1 ? " body: " : " bodies: ") + text;
}

inline Json choices_json(const WorldReport& report) {
    Json choices = Json::array();
    for (const DynamicsChoice& choice : report.dynamics_choices) {
        const DynamicsEstimate& e = choice.estimate;
        Json json = object_of({{"body", choice.name},
                               {"dynamics", name_of(choice.dynamics)},
                               {"reason", name_of(e.reason)},
                               {"strain", e.strain}});
        if (e.reason == DynamicsReason::cost)
            json.update(object_of(
                {{"explicit", object_of({{"dt", e.explicit_step}, {"cpu_seconds_per_second", e.explicit_cost}})},
                 {"implicit", object_of({{"dt", e.implicit_step},
                                         {"deforming_dt", e.deforming_step},
                                         {"cpu_seconds_per_second", e.implicit_cost}})},
                 {"damped_above_hz", e.damped_above}}));
        choices.push_back(json);
    }
    return choices;
}

}  // namespace skerry
