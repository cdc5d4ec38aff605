#include "engine/study/study_columns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>
#include <string_view>
#include <utility>
#include <variant>

#include "engine/scene/scene_plan.h"
#include "systems/dynamics/elements/element_energy.h"

namespace skerry {

namespace {

// largest number of bodies with columns of their own in the report
constexpr std::size_t most_reported = 20;
// Largest number of bodies whose displacements are recorded one by one. In larger scenes only the mean, least and
// largest displacements of all bodies are recorded.
constexpr std::size_t most_recorded = 1000;

bool starts_with_any(std::string_view text, std::span<const std::string_view> starts) {
    return std::ranges::any_of(starts, [&](std::string_view start) { return text.starts_with(start); });
}

/// True for the quantities of the default probe of a body that become columns of the study. The other quantities of the
/// probe are dropped.
bool is_default(std::string_view quantity) {
    static constexpr std::array<std::string_view, 3> recorded{"displacement_", "force_", "largest_von_mises"};
    return starts_with_any(quantity, recorded);
}

/// False for quantities that repeat others or depend on the mesh only: a position is a displacement with an offset, an
/// impulse is a force times a duration, and finer meshes have more contacts.
bool is_main(std::string_view quantity) {
    static constexpr std::array<std::string_view, 5> secondary{"position_", "impulse_", "contacts", "sticking",
                                                               "sliding"};
    return !starts_with_any(quantity, secondary);
}

Real diagonal(const World& world, std::span<const BodyHandle> bodies) {
    Vec3 lower = Vec3::Constant(infinity), upper = Vec3::Constant(-infinity);
    for (const BodyHandle body : bodies)
        for (const Vec3& node : world.positions(body)) {
            lower = lower.cwiseMin(node);
            upper = upper.cwiseMax(node);
        }
    return bodies.empty() ? 0 : (upper - lower).norm();
}

/// Body of a probe, if it has one.
std::optional<BodyHandle> body_of(const RecordedProbe& probe) {
    return std::visit(
        [](const auto& object) -> std::optional<BodyHandle> {
            if constexpr (requires { object.body; })
                return object.body;
            else
                return {};
        },
        probe.what);
}

/// True if the scene has a probe of the given kind for which `matches` returns true.
template <class Kind>
bool has_probe(const Scene& scene, auto matches) {
    return std::ranges::any_of(scene.recorded, [&](const RecordedProbe& probe) {
        const Kind* const object = std::get_if<Kind>(&probe.what);
        return object && matches(*object);
    });
}

std::vector<RecordedProbe> joined(std::vector<RecordedProbe> probes, const auto& defaults) {
    for (const auto& added : defaults) probes.push_back(added.probe);
    return probes;
}

/// Returns the recorded probes of a scene. For each contact probe on a deformable body it adds a probe of the stress at
/// the same nodes. Rigid bodies have no stress.
std::vector<RecordedProbe> probes_of(const Scene& scene) {
    std::vector<RecordedProbe> probes = scene.recorded;
    for (const Probe& probe : scene.probes)
        if (scene.world.dynamics(probe.body) != BodyDynamics::rigid)
            probes.push_back({probe.name, StressProbe{probe.body, probe.nodes}});
    return probes;
}

}  // namespace

std::vector<StudyRecorder::DefaultProbe> StudyRecorder::default_probes(const Scene& scene) {
    const World& world = scene.world;
    std::vector<DefaultProbe> probes;
    std::vector<BodyHandle> attached;
    for (const AttachmentHandle attachment : world.attachments()) attached.push_back(world.body(attachment));
    std::set<std::string> probe_names;
    for (const RecordedProbe& probe : scene.recorded) probe_names.insert(probe.name);
    for (const Probe& probe : scene.probes) probe_names.insert(probe.name);
    std::set<std::string> names = probe_names;  // names of probes and bodies
    for (const BodyHandle body : world.bodies()) names.insert(world.name(body));
    for (const BodyHandle body : bodies_in_order(world)) {
        std::string display_name = world.name(body);
        if (display_name == "bodies" || probe_names.contains(display_name)) {  // statistics of all bodies use "bodies"
            do display_name = "body " + display_name;
            while (!names.insert(display_name).second);
        }
        const auto add = [&](decltype(RecordedProbe::what) what) {
            probes.push_back({{"default probe " + std::to_string(probes.size()), std::move(what)},
                              display_name,
                              body,
                              std::ranges::find(attached, body) == attached.end()});
        };
        if (!has_probe<BodyProbe>(scene, [&](const BodyProbe& p) { return p.body == body; })) add(BodyProbe{body});
        if (!has_probe<BodyForceProbe>(scene, [&](const BodyForceProbe& p) { return p.body == body && !p.by; }))
            add(BodyForceProbe{body});
        if (world.dynamics(body) != BodyDynamics::rigid &&
            !has_probe<StressProbe>(scene, [&](const StressProbe& p) { return p.body == body && p.nodes.empty(); }))
            add(StressProbe{body});
    }
    if (!has_probe<EnergyProbe>(scene, [](const EnergyProbe&) { return true; }))
        probes.push_back({{"default probe " + std::to_string(probes.size()), EnergyProbe{}}, "energy"});
    return probes;
}

StudyRecorder::StudyRecorder(Scene& scene)
    : world_(scene.world),
      defaults_(default_probes(scene)),
      recorder_(scene.world, joined(probes_of(scene), defaults_)),
      contacts_(scene) {
    const std::vector<BodyHandle> bodies = world_.bodies();
    size_ = diagonal(world_, bodies);
    many_bodies_ = bodies.size() > most_reported;
    add_sources(probes_of(scene));
}

void StudyRecorder::add_sources(const std::vector<RecordedProbe>& of_scene) {
    std::string of_all = "bodies";  // probe name of the columns with statistics of all bodies
    while (std::ranges::find(of_scene, of_all, &RecordedProbe::name) != of_scene.end()) of_all = "all " + of_all;
    // For each quantity of bodies without attachments: the name and unit of its statistics, and the columns of
    // `recorder_` with the values of the single bodies.
    std::vector<std::pair<SeriesColumn, std::vector<std::size_t>>> of_bodies;
    const bool keep_bodies = defaults_.size() <= 3 * most_recorded;
    std::size_t c = 1;  // column 0 is the time
    const auto add_stress = [&](const RecordedProbe& probe) {
        const StressProbe* const stress = std::get_if<StressProbe>(&probe.what);
        if (!stress || recorder_.columns()[c].quantity != "largest_von_mises") return;
        const std::span<const Vec3> start = world_.positions(stress->body);
        stresses_.push_back({c, *stress, {start.begin(), start.end()}});
    };
    const auto add = [&](const RecordedProbe& probe, const std::string& display_name, bool reported) {
        const std::optional<BodyHandle> body = body_of(probe);
        StudyColumn column{
            .what = recorder_.columns()[c], .size = body ? diagonal(world_, {&*body, 1}) : size_, .reported = reported};
        column.what.probe = display_name;
        add_stress(probe);
        sources_.push_back({std::move(column), Statistic::mean, {c}, body ? world_.name(*body) : std::string()});
    };
    for (const RecordedProbe& probe : of_scene)
        for (; c < recorder_.columns().size() && recorder_.columns()[c].probe == probe.name; ++c)
            add(probe, probe.name, is_main(recorder_.columns()[c].quantity));
    for (const DefaultProbe& added : defaults_)
        for (; c < recorder_.columns().size() && recorder_.columns()[c].probe == added.probe.name; ++c) {
            const SeriesColumn& series = recorder_.columns()[c];
            if (added.body == BodyHandle{}) {
                add(added.probe, added.shown, true);
                continue;
            }
            if (!is_default(series.quantity)) continue;
            if (!many_bodies_ || (keep_bodies && series.quantity.starts_with("displacement_")))
                add(added.probe, added.shown, !many_bodies_);
            if (!added.is_unattached) continue;
            auto found = std::ranges::find(of_bodies, series.quantity, [](const auto& e) { return e.first.quantity; });
            if (found == of_bodies.end()) found = of_bodies.insert(found, {{of_all, series.quantity, series.unit}, {}});
            found->second.push_back(c);
        }
    for (const auto& [series, columns_of_bodies] : of_bodies)
        for (const auto& [statistic, name] :
             {std::pair{Statistic::mean, "mean_"}, std::pair{Statistic::least, "least_"},
              std::pair{Statistic::largest, "largest_"}}) {
            if (columns_of_bodies.size() < 2) continue;
            const bool doubled = series.quantity.starts_with(name);
            sources_.push_back(
                {{.what = {series.probe, doubled ? series.quantity : name + series.quantity, series.unit},
                  .size = size_,
                  .is_statistic = true},
                 statistic,
                 columns_of_bodies});
        }
}

void StudyRecorder::sample() {
    recorder_.sample(world_);
    if (rows_ == recorder_.row_count()) return;
    const Real before = rows_ > 0 ? recorder_.row(rows_ - 1)[0] : world_.time();
    contacts_.sample(world_, world_.time() - before);
    const std::span<const Real> row = recorder_.row(rows_++);
    for (Stress& stress : stresses_) {
        if (!(row[stress.column] > stress.largest)) continue;
        stress.largest = row[stress.column];
        const std::vector<Index>& nodes = stress.probe.nodes;
        const std::vector<Mat3> values =
            nodes.empty() ? world_.node_stress(stress.probe.body) : world_.node_stress(stress.probe.body, nodes);
        const auto largest = std::ranges::max_element(values, {}, von_mises);
        const auto number = static_cast<std::size_t>(largest - values.begin());
        stress.node = nodes.empty() ? static_cast<Index>(number) : nodes[number];
    }
}

std::vector<std::string> StudyRecorder::bodies() const {
    std::vector<std::string> names;
    for (const ColumnSource& source : sources_) names.push_back(source.body);
    names.resize(names.size() + contact_columns().size());
    return names;
}

std::vector<Real> StudyRecorder::time() const {
    std::vector<Real> times;
    for (std::size_t r = 0; r < recorder_.row_count(); ++r) times.push_back(recorder_.row(r)[0]);
    return times;
}

std::vector<StudyColumn> StudyRecorder::columns() const {
    std::vector<StudyColumn> columns;
    for (const ColumnSource& source : sources_) {
        StudyColumn& column = columns.emplace_back(source.column);
        for (std::size_t r = 0; r < recorder_.row_count(); ++r) {
            const std::span<const Real> row = recorder_.row(r);
            Real sum = 0, least = infinity, largest = -infinity;
            for (const std::size_t c : source.recorder_columns) {
                sum += row[c];
                least = std::min(least, row[c]);
                largest = std::max(largest, row[c]);
            }
            const Real mean = sum / static_cast<Real>(source.recorder_columns.size());
            column.values.push_back(source.statistic == Statistic::mean || std::isnan(mean) ? mean
                                    : source.statistic == Statistic::least                  ? least
                                                                                            : largest);
        }
        const auto stress = std::ranges::find(stresses_, source.recorder_columns.front(), &Stress::column);
        if (source.recorder_columns.size() > 1 || stress == stresses_.end() || stress->node == no_index) continue;
        column.node = stress->node;
        column.place = stress->start[static_cast<std::size_t>(stress->node)];
    }
    std::ranges::move(contact_columns(), std::back_inserter(columns));
    return columns;
}

std::vector<StudyColumn> StudyRecorder::contact_columns() const {
    std::vector<StudyColumn> columns;
    for (const ProbeRecord& record : contacts_.records()) {
        const auto add = [&](const char* quantity, const char* unit, const auto& values) {
            columns.push_back({.what = {record.name, quantity, unit},
                               .size = size_,
                               .reported = is_main(quantity),
                               .values = {values.begin(), values.end()}});
        };
        add("sticking", "1", record.sticking);
        add("sliding", "1", record.sliding);
        add("slip", "m/s", record.slip);
    }
    return columns;
}

void choose_columns_by_name(const std::vector<std::string>& names, const std::filesystem::path& file,
                            std::vector<StudyColumn>& columns) {
    if (names.empty()) return;
    for (StudyColumn& column : columns) column.reported = false;
    for (const std::string& name : names) {
        bool found = false;
        for (StudyColumn& column : columns) {
            const std::string full = column.what.probe + "." + column.what.quantity;
            const bool chosen = column.what.probe == name || full == name ||
                                (name.starts_with(column.what.probe + ".") && full.starts_with(name + "_"));
            column.reported |= chosen;
            found |= chosen;
        }
        if (found) continue;
        std::vector<std::string> known;
        for (const StudyColumn& column : columns)
            if (known.empty() || known.back() != column.what.probe) known.push_back(column.what.probe);
        refuse_in(file.string(), "study", "probe", in_quotes(name),
                  "NAME or NAME.QUANTITY, where NAME is one of " + listed(known), nearest_hint(name, known));
    }
}

}  // namespace skerry
