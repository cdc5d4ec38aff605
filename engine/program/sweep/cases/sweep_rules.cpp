// JSON keys of a file of cases, with their meaning and their checks.
#include <cmath>

#include "engine/program/sweep/cases/sweep_file.h"
#include "engine/scene/parse_json.h"

namespace skerry {

namespace {

constexpr Real largest_seed = 4294967295;

const KeyDoc set_doc{.meaning =
                         "place of the varied value in the scene, as in `skerry run --set`, for example "
                         "materials.rubber.young_modulus; or a list of places that all get the same value",
                     .required = true};
const KeyDoc name_doc{
    .meaning = "column heading of this parameter in tables; default: the place in the scene that the parameter sets"};

/// A double represents every whole number up to this number exactly.
constexpr Real most_whole = 9007199254740992.0;  // 2^53

void check_ends(const Place& place, Real from, Real to, bool log) {
    if (log && !(from > 0))
        place.key("from").refuse(Json(from).dump(), "a number above 0, because the scale is logarithmic");
    if (log && !(to > 0)) place.key("to").refuse(Json(to).dump(), "a number above 0, because the scale is logarithmic");
}

void check_grid(const Place& place, const GridEntry& entry) {
    if (!entry.from) {
        if (entry.values.empty()) place.key("values").refuse("an empty list", "at least one value");
        return;
    }
    check_ends(place, *entry.from, *entry.to, entry.spacing == Spacing::log);
    if (entry.count > 1 && *entry.from == *entry.to)
        place.key("to").refuse(Json(*entry.to).dump() + ", the same number as \"from\"",
                               "a number different from \"from\", or a \"count\" of 1");
}

void check_drawn(const Place& place, const DrawnEntry& entry) {
    const std::string distribution_text = "the distribution " + in_quotes(name_of(entry.distribution));
    const bool normal = entry.distribution == Distribution::normal;
    const auto need = [&](const char* key, bool is_given, bool is_needed) {
        if (is_needed && !is_given)
            place.refuse("no key " + in_quotes(key),
                         "the key " + in_quotes(key) + ", which " + distribution_text + " requires");
        if (is_given && !is_needed)
            place.key(key).refuse("a key that is not used by " + distribution_text,
                                  normal ? "the keys \"mean\" and \"deviation\"" : "the keys \"from\" and \"to\"");
    };
    need("from", entry.from.has_value(), !normal);
    need("to", entry.to.has_value(), !normal);
    need("mean", entry.mean.has_value(), normal);
    need("deviation", entry.deviation.has_value(), normal);
    if (normal) return;
    check_ends(place, *entry.from, *entry.to, entry.distribution == Distribution::log_uniform);
    if (!(*entry.to > *entry.from))
        place.key("to").refuse(Json(*entry.to).dump(),
                               "a number above the value of \"from\", " + Json(*entry.from).dump());
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
        Rule<G>("grid_parameter",
                "A parameter of a grid. The cases are all combinations of the parameters' values; the last parameter "
                "varies fastest.")
            .key("name", &G::name, name_doc)
            .key("set", &G::set, set_doc)
            .key("values", &G::values,
                 {.meaning = "list of the values: numbers, texts or lists, as the place in the scene requires"})
            .key("from", &G::from, {.meaning = "first of \"count\" values"})
            .key("to", &G::to, {.meaning = "last of \"count\" values"})
            .key("count", &G::count,
                 {.meaning = "number of values, including \"from\" and \"to\"", .limits = within(1, most_cases)})
            .key("spacing", &G::spacing,
                 {.meaning = "spacing of the values. linear (default): equal differences; log: equal ratios"})
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
        Rule<D>("random_parameter",
                "A parameter with a random value in every case, independent of all other parameters.")
            .key("name", &D::name, name_doc)
            .key("set", &D::set, set_doc)
            .key("distribution", &D::distribution,
                 {.meaning = "probability distribution of the value. uniform (default): between \"from\" and \"to\"; "
                             "log_uniform: uniform distribution of the logarithm; integer: whole numbers, including "
                             "\"from\" and \"to\"; normal: given by \"mean\" and \"deviation\""})
            .key("from", &D::from, {.meaning = "lower end of the interval"})
            .key("to", &D::to, {.meaning = "upper end of the interval"})
            .key("mean", &D::mean, {.meaning = "mean of a normal distribution"})
            .key("deviation", &D::deviation,
                 {.meaning = "standard deviation of a normal distribution", .limits = above(0)})
            .check(check_drawn);
    return rule;
}

template <>
const Rule<RandomEntry>& rule_of<RandomEntry>() {
    using R = RandomEntry;
    static const auto rule =
        Rule<R>("random", "Cases with random values. A higher count adds cases and leaves the earlier ones unchanged.")
            .key("seed", &R::seed,
                 {.meaning = "seed of the random numbers; the same seed gives the same cases on every machine",
                  .limits = within(0, largest_seed),
                  .required = true})
            .key("count", &R::count, {.meaning = "number of cases", .limits = within(1, most_cases), .required = true})
            .key("parameters", &R::parameters,
                 {.meaning = "parameters with random values; the values of a case are drawn in this order",
                  .required = true})
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
        Rule<S>("sweep", "A sweep: cases of one scene that differ in some values (docs/sweep.md).")
            .key("$schema", &S::schema, {.meaning = "path or address of this schema, for editors"})
            .key("name", &S::name, {.meaning = "name of the sweep; default: the name of the file"})
            .key("description", &S::description, {.meaning = "purpose of the sweep, as free text"})
            .key("scene", &S::scene,
                 {.meaning = "path of the scene file, relative to the folder of this file", .required = true})
            .key(
                "set", &S::set,
                {.meaning = "values that all cases share, by place in the scene; the values of a case take precedence"})
            .key("grid", &S::grid, {.meaning = "parameters; the cases are all combinations of their values"})
            .key("list", &S::list,
                 {.meaning = "list of cases, each an object with the values of the case by place in the scene"})
            .key("random", &S::random, {.meaning = "cases with random values"})
            .exactly_one({"grid", "list", "random"})
            .check([](const Place& place, const S& sweep) {
                if (!sweep.random && sweep.grid.empty() && sweep.list.empty())
                    place.refuse("an empty list of cases",
                                 "at least one parameter in \"grid\", or one case in \"list\"");
            });
    return rule;
}

std::string sweep_schema() {
    return schema_document("Skerry sweep", rule_of<SweepFile>());
}

SweepFile read_sweep_file(const std::filesystem::path& file) {
    SweepFile sweep;
    rule_of<SweepFile>().read(read_json(file, "cases in JSON, as described by `skerry sweep --help`"), Place(file),
                              sweep);
    sweep.place = Place(file);
    if (sweep.name.empty()) sweep.name = file.stem().string();
    return sweep;
}

}  // namespace skerry
