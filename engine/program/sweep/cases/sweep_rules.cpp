// JSON keys of a file of cases, with their meaning and their checks.
#include <cmath>

#include "engine/program/sweep/cases/sweep_file.h"
#include "engine/scene/parse_json.h"

namespace skerry {

namespace {

constexpr Real largest_seed = 4294967295;

const KeyDoc set_doc{.meaning = "the place in the scene, as `skerry run --set` takes it; several take the same value",
                     .required = true};
const KeyDoc name_doc{.meaning = "of the column in tables; by default the place"};

/// A double represents every whole number up to this number exactly.
constexpr Real most_whole = 9007199254740992.0;  // 2^53

void check_ends(const Place& place, Real from, Real to, bool log) {
    if (log && !(from > 0)) place.key("from").refuse(Json(from).dump(), "a number above 0: its logarithm counts");
    if (log && !(to > 0)) place.key("to").refuse(Json(to).dump(), "a number above 0: its logarithm counts");
}

void check_grid(const Place& place, const GridEntry& entry) {
    if (!entry.from) {
        if (entry.values.empty()) place.key("values").refuse("an empty list", "at least one value");
        return;
    }
    check_ends(place, *entry.from, *entry.to, entry.spacing == Spacing::log);
    if (entry.count > 1 && *entry.from == *entry.to)
        place.key("to").refuse(Json(*entry.to).dump() + ", which is where it begins",
                               "another number than \"from\", or a count of 1");
}

void check_drawn(const Place& place, const DrawnEntry& entry) {
    const std::string of = "for the distribution " + in_quotes(name_of(entry.distribution));
    const bool normal = entry.distribution == Distribution::normal;
    const auto need = [&](const char* key, bool given, bool wanted) {
        if (wanted && !given) place.refuse("no key " + in_quotes(key), in_quotes(key) + " " + of);
        if (given && !wanted)
            place.key(key).refuse("a key that says nothing " + of, normal ? "mean and deviation" : "from and to");
    };
    need("from", entry.from.has_value(), !normal);
    need("to", entry.to.has_value(), !normal);
    need("mean", entry.mean.has_value(), normal);
    need("deviation", entry.deviation.has_value(), normal);
    if (normal) return;
    check_ends(place, *entry.from, *entry.to, entry.distribution == Distribution::log_uniform);
    if (!(*entry.to > *entry.from))
        place.key("to").refuse(Json(*entry.to).dump(), "a number above \"from\", " + Json(*entry.from).dump());
    if (entry.distribution == Distribution::integer)
        for (const auto& [key, end] : {std::pair{"from", *entry.from}, std::pair{"to", *entry.to}})
            if (end != std::floor(end) || std::abs(end) > most_whole)
                place.key(key).refuse(Json(end).dump(), "a whole number");
}

}  // namespace

template <>
const Rule<GridEntry>& rule_of<GridEntry>() {
    using G = GridEntry;
    static const auto rule =
        Rule<G>("grid_parameter", "A parameter of a grid, whose cases are all combinations; the last one varies first.")
            .key("name", &G::name, name_doc)
            .key("set", &G::set, set_doc)
            .key("values", &G::values, {.meaning = "one by one: numbers, texts, lists, as the place takes them"})
            .key("from", &G::from, {.meaning = "the first of \"count\" numbers"})
            .key("to", &G::to, {.meaning = "the last of them"})
            .key("count", &G::count, {.meaning = "how many, both ends included", .limits = within(1, most_cases)})
            .key("spacing", &G::spacing, {.meaning = "linear (default): equal differences; log: equal ratios"})
            .exactly_one({"values", "from"})
            .together({"from", "to", "count"})
            .at_most_one({"values", "spacing"})
            .check(check_grid);
    return rule;
}

template <>
const Rule<DrawnEntry>& rule_of<DrawnEntry>() {
    using D = DrawnEntry;
    static const auto rule =
        Rule<D>("random_parameter", "A parameter that is drawn for every case, of all others independently.")
            .key("name", &D::name, name_doc)
            .key("set", &D::set, set_doc)
            .key("distribution", &D::distribution,
                 {.meaning = "uniform (default); log_uniform: its logarithm is; integer: whole numbers, both ends "
                             "included; normal"})
            .key("from", &D::from, {.meaning = "lower end"})
            .key("to", &D::to, {.meaning = "upper end"})
            .key("mean", &D::mean, {.meaning = "of a normal distribution"})
            .key("deviation", &D::deviation,
                 {.meaning = "standard deviation of a normal distribution", .limits = above(0)})
            .check(check_drawn);
    return rule;
}

template <>
const Rule<RandomEntry>& rule_of<RandomEntry>() {
    using R = RandomEntry;
    static const auto rule =
        Rule<R>("random", "Cases that are drawn. A higher count adds cases and changes none.")
            .key("seed", &R::seed,
                 {.meaning = "the same one gives the same cases on every machine",
                  .limits = within(0, largest_seed),
                  .required = true})
            .key("count", &R::count, {.meaning = "of cases", .limits = within(1, most_cases), .required = true})
            .key("parameters", &R::parameters, {.meaning = "what is drawn, in this order", .required = true})
            .check([](const Place& place, const R& random) {
                if (random.parameters.empty())
                    place.key("parameters").refuse("an empty list", "at least one parameter");
            });
    return rule;
}

template <>
const Rule<SweepFile>& rule_of<SweepFile>() {
    using S = SweepFile;
    static const auto rule =
        Rule<S>("sweep", "Cases of a scene: the same scene with other values (docs/sweep.md).")
            .key("$schema", &S::schema, {.meaning = "where editors find this schema"})
            .key("name", &S::name, {.meaning = "of the sweep; by default that of the file"})
            .key("description", &S::description, {.meaning = "what it is to show"})
            .key("scene", &S::scene, {.meaning = "the scene file", .required = true})
            .key("set", &S::set, {.meaning = "values by place that every case has, before its own"})
            .key("grid", &S::grid, {.meaning = "all combinations of the values of these parameters"})
            .key("list", &S::list, {.meaning = "case by case, values by place"})
            .key("random", &S::random, {.meaning = "cases that are drawn"})
            .exactly_one({"grid", "list", "random"})
            .check([](const Place& place, const S& sweep) {
                if (!sweep.random && sweep.grid.empty() && sweep.list.empty())
                    place.refuse("an empty list of cases", "at least one parameter in \"grid\", or case in \"list\"");
            });
    return rule;
}

std::string sweep_schema() {
    return schema_document("Skerry sweep", rule_of<SweepFile>());
}

SweepFile read_sweep_file(const std::filesystem::path& file) {
    SweepFile sweep;
    rule_of<SweepFile>().read(read_json(file, "cases in JSON (skerry sweep --help)"), Place(file), sweep);
    sweep.place = Place(file);
    if (sweep.name.empty()) sweep.name = file.stem().string();
    return sweep;
}

}  // namespace skerry
