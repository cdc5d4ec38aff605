#include "engine/scene/probe_recorder.h"

#include <algorithm>
#include <span>
#include <stdexcept>
#include <utility>

#include "systems/dynamics/elements/element_energy.h"

namespace skerry {

namespace {

struct Sample {
    int sticking = 0, sliding = 0;
    Real slip = 0;  // slip speeds of the contacts: first their sum, later their mean [m/s]
};

/// True if the contact acts on a node of the probe. `inside`: for each node of `body`, nonzero if the node belongs to
/// the probe.
bool touches(const Contact& contact, BodyHandle body, const std::vector<char>& inside) {
    for (std::size_t a = 0; a < 4; ++a) {
        // In the weighted sum of nodal velocities, weights of the first object are positive, of the second negative.
        const bool ours =
            (contact.weight[a] > 0 && contact.first == body) || (contact.weight[a] < 0 && contact.second == body);
        if (ours && inside[static_cast<std::size_t>(contact.node[a])] != 0) return true;
    }
    return false;
}

/// Returns the largest von Mises stress at some nodes [Pa]. `nodes`: indices of their stresses in `stress`.
Real largest_von_mises(std::span<const Mat3> stress, std::span<const std::size_t> nodes) {
    Real largest = 0;
    for (const std::size_t n : nodes) largest = std::max(largest, von_mises(stress[n]));
    return largest;
}

}  // namespace

ProbeRecorder::ProbeRecorder(const Scene& scene) {
    for (const Probe& probe : scene.probes) {
        Tracked tracked{.body = probe.body, .inside = std::vector<char>(scene.world.positions(probe.body).size(), 0)};
        for (const Index node : probe.nodes) tracked.inside[static_cast<std::size_t>(node)] = 1;
        auto stress = std::ranges::find(stress_nodes_, probe.body, &StressNodes::body);
        if (stress == stress_nodes_.end()) stress = stress_nodes_.insert(stress, {.body = probe.body});
        tracked.stress_row = static_cast<std::size_t>(stress - stress_nodes_.begin());
        for (const Index node : probe.nodes) {
            tracked.stress_rows.push_back(stress->nodes.size());
            stress->nodes.push_back(node);
        }
        tracked_.push_back(std::move(tracked));
        records_.emplace_back().name = probe.name;
    }
}

void ProbeRecorder::sample(const World& world, Real seconds) {
    std::vector<State> states;
    std::vector<std::vector<Mat3>> stress;
    for (const StressNodes& of : stress_nodes_) stress.push_back(world.node_stress(of.body, of.nodes));
    for (std::size_t p = 0; p < tracked_.size(); ++p) {
        Tracked& tracked = tracked_[p];
        ProbeRecord& record = records_[p];
        Sample sample;
        for (const Contact& contact : world.contacts()) {
            if (contact.motion == ContactMotion::open || !touches(contact, tracked.body, tracked.inside)) continue;
            ++(contact.motion == ContactMotion::slide ? sample.sliding : sample.sticking);
            sample.slip += contact.slip.norm();
        }
        const int closed = sample.sticking + sample.sliding;
        if (closed > 0) sample.slip /= closed;
        // A probe counts as sliding if at least half of its closed contacts slide.
        const State state = closed == 0 ? State::open : (2 * sample.sliding >= closed ? State::slide : State::stick);
        states.push_back(state);

        (state == State::open    ? record.open_time
         : state == State::slide ? record.slide_time
                                 : record.stick_time) += seconds;
        if (state != State::open && tracked.last_closed != State::open && state != tracked.last_closed)
            ++record.changes;
        if (state != State::open) tracked.last_closed = state;
        record.max_slip = std::max(record.max_slip, sample.slip);
        record.slip_distance += sample.slip * seconds;
        record.time.push_back(world.time());
        record.sticking.push_back(sample.sticking);
        record.sliding.push_back(sample.sliding);
        record.slip.push_back(sample.slip);
        record.von_mises.push_back(largest_von_mises(stress[tracked.stress_row], tracked.stress_rows));
        record.max_von_mises = std::max(record.max_von_mises, record.von_mises.back());
    }
    if (std::count(states.begin(), states.end(), State::slide) == 1)
        records_[static_cast<std::size_t>(std::find(states.begin(), states.end(), State::slide) - states.begin())]
            .slide_alone_time += seconds;
}

Json ProbeRecorder::saved() const {
    Json all = Json::array();
    for (std::size_t p = 0; p < records_.size(); ++p) {
        Json probe = to_json(records_[p]);
        probe["name"] = records_[p].name;
        probe["last_closed"] = static_cast<int>(tracked_[p].last_closed);
        all.push_back(std::move(probe));
    }
    return all;
}

void ProbeRecorder::go_on(const Json& saved) {
    const std::string restore = ": restore the probes of the scene from which the checkpoint was written";
    if (saved.size() != records_.size())
        throw std::out_of_range("the checkpoint has " + std::to_string(saved.size()) +
                                " contact probes, but the scene has " + std::to_string(records_.size()) + restore);
    for (std::size_t p = 0; p < records_.size(); ++p) {
        const Json& probe = saved.at(p);
        const std::string name = probe.at("name").get<std::string>();
        if (name != records_[p].name)
            throw std::out_of_range("the checkpoint has the probe \"" + name + "\" where the scene has \"" +
                                    records_[p].name + "\"" + restore);
        from_json(probe, records_[p]);
        tracked_[p].last_closed = static_cast<State>(probe.at("last_closed").get<int>());
    }
}

void from_json(const Json& json, ProbeRecord& record) {
    json.at("stick_time").get_to(record.stick_time);
    json.at("slide_time").get_to(record.slide_time);
    json.at("open_time").get_to(record.open_time);
    json.at("slide_alone_time").get_to(record.slide_alone_time);
    json.at("changes").get_to(record.changes);
    json.at("max_slip").get_to(record.max_slip);
    json.at("slip_distance").get_to(record.slip_distance);
    json.at("max_von_mises").get_to(record.max_von_mises);
    const Json& series = json.at("series");
    series.at("time").get_to(record.time);
    series.at("sticking").get_to(record.sticking);
    series.at("sliding").get_to(record.sliding);
    series.at("slip").get_to(record.slip);
    series.at("von_mises").get_to(record.von_mises);
}

Json to_json(const ProbeRecord& record) {
    return object_of({{"stick_time", record.stick_time},
                      {"slide_time", record.slide_time},
                      {"open_time", record.open_time},
                      {"slide_alone_time", record.slide_alone_time},
                      {"changes", record.changes},
                      {"max_slip", record.max_slip},
                      {"slip_distance", record.slip_distance},
                      {"max_von_mises", record.max_von_mises},
                      {"series", object_of({{"time", record.time},
                                            {"sticking", record.sticking},
                                            {"sliding", record.sliding},
                                            {"slip", record.slip},
                                            {"von_mises", record.von_mises}})}});
}

}  // namespace skerry
