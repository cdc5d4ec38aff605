#include "engine/program/contact_area_text.h"

#include <algorithm>
#include <cmath>

#include "engine/output/number_text.h"

namespace skerry {

namespace {

// Smallest number of edges per radius of a contact area for which the mesh resolves the stress in the area. With fewer
// edges the computed stress is that of single nodes.
constexpr Real resolves_stress = 1;
// Smallest number n of edges per radius of a contact area for which the duration of impacts is accepted. An impact
// takes about `impact_duration` * sqrt(n) times as long as by the theory of Hertz (n = 0.25: 0.84 times), because the
// stiffness of a single node does not grow with the contact area.
constexpr Real resolves_impacts = 0.25;
constexpr Real impact_duration = 1.67;

/// Quantities of a body that probes of a scene measure.
struct Probed {
    bool stress = false, force = false;
};

std::vector<Probed> probed_bodies(const ScenePlan& plan) {
    std::vector<Probed> probed(plan.bodies.size());
    for (const SeriesPlan& series : plan.series) {
        if (series.quantity == ProbeQuantity::stress && series.nodes.empty()) probed[*series.body].stress = true;
        if (series.quantity != ProbeQuantity::force) continue;
        for (const std::optional<std::size_t>& body : {series.body, series.by_body})
            if (body) probed[*body].force = true;
    }
    return probed;
}

std::string text_of(const ErrorEstimate& estimate, const Probed& probed) {
    const Real cells = estimate.contact_radius / estimate.contact_edge;
    const bool stress = probed.stress && cells < resolves_stress, force = probed.force && cells < resolves_impacts;
    if (!stress && !force) return {};
    std::string effect;
    if (force)
        effect = "impacts take about " + short_text(impact_duration * std::sqrt(cells), 2) +
                 " times as long as they should, and their forces are too large accordingly";
    if (stress) effect += force ? ", and the stress there is wrong" : "the stress there is wrong";
    const Real finer = (stress ? 2 * resolves_stress : resolves_impacts) / cells;
    return "the contact areas of body '" + estimate.name + "' have a radius of up to " +
           with_unit(estimate.contact_radius, "m") + " by the theory of Hertz, less than the edges there, " +
           with_unit(estimate.contact_edge, "m") + ": " + effect + ": make the cells there " + short_text(finer, 2) +
           " times smaller";
}

}  // namespace

std::vector<std::string> contact_area_texts(const ScenePlan& plan, const World& world,
                                            std::span<const ErrorEstimate> errors) {
    std::vector<std::string> texts;
    const std::vector<Probed> probed = probed_bodies(plan);
    const std::vector<BodyHandle> bodies = bodies_in_order(world);
    for (std::size_t b = 0; b < probed.size(); ++b) {
        if (!probed[b].stress && !probed[b].force) continue;
        const auto estimate = std::ranges::find(errors, bodies[b], &ErrorEstimate::body);
        if (estimate == errors.end()) continue;
        if (std::string text = text_of(*estimate, probed[b]); !text.empty()) texts.push_back(std::move(text));
    }
    return texts;
}

}  // namespace skerry
