#include "engine/study/analysis/measure.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "engine/output/number_text.h"
#include "engine/output/series/series_summary.h"

namespace skerry {

namespace {

constexpr Real no_value = std::numeric_limits<Real>::quiet_NaN();
// Fraction of the error bar. A part of the error (from the mesh, the steps or the contacts) that does not decrease
// regularly from run to run is ignored below this fraction.
constexpr Real least_share_of_bar = 0.2;

const char* ending_of(StudyFigure figure) {
    switch (figure) {
        case StudyFigure::end:
            return "_end";
        case StudyFigure::largest:
            return "_max";
        case StudyFigure::smallest:
            return "_min";
        case StudyFigure::mean:
            return "_mean";
        case StudyFigure::agreed:
            return "_agreed";
    }
    return "";
}

std::size_t row_of_time(const StudyRun& run, Real time) {
    return static_cast<std::size_t>(std::ranges::upper_bound(run.time, time) - run.time.begin()) - 1;
}

Real figure_value(const StudyRun& run, std::size_t column, StudyFigure figure, Real agree_until) {
    const std::vector<Real>& values = run.columns[column].values;
    if (figure == StudyFigure::agreed) return values[row_of_time(run, agree_until)];
    const SeriesSummary found = summary_of_series(run.time, values);
    return figure == StudyFigure::end       ? found.end
           : figure == StudyFigure::mean    ? found.mean
           : figure == StudyFigure::largest ? found.most
                                            : found.least;
}

/// Returns the name of the group of columns that share a scale: the energies or the forces of a probe, or the
/// components of a vector.
std::string group_of(const SeriesColumn& column) {
    if (column.unit == "J" || column.unit == "N") return column.probe + " [" + column.unit + "]";
    const std::string& name = column.quantity;
    const bool component = name.size() > 2 && name[name.size() - 2] == '_' && name.back() >= 'x' && name.back() <= 'z';
    return column.probe + "." + (component ? name.substr(0, name.size() - 2) : name);
}

TheoryOrder mesh_theory(const SeriesColumn& column) {
    // Stresses of linear elements have order 1, and up to 2 if they are recovered at the nodes.
    return column.unit == "Pa" ? TheoryOrder{1, 2} : TheoryOrder{2, 2};
}

TheoryOrder step_theory(const StudyRun& scene) {
    // Leapfrog without contacts has order 2. In all other cases the order may be as low as 1
    // (docs/methods/time_stepping.md 1.4).
    return scene.integrator == Integrator::leapfrog && scene.max_contacts == 0 ? TheoryOrder{2, 2} : TheoryOrder{1, 2};
}

bool is_mesh(const StudyVariant& v) {
    return v.step == 1 && v.tolerance == 1 && !v.element && v.draw == 0;
}
bool is_step(const StudyVariant& v) {
    return v.refine == 0 && v.tolerance == 1 && !v.element && v.draw == 0;
}
bool is_contact(const StudyVariant& v) {
    return v.refine == 0 && v.step == 1 && !v.element && v.draw == 0;
}

/// Growth of a stress figure, such as the largest value of a column, from mesh to mesh.
struct StressGrowth {
    // exponents a with which the stress grows, as h^-a with the edge length h, from each mesh to the next finer one
    std::vector<Real> rates{};
    bool same_place = false;  // true if the two finest meshes have their largest stress near one place

    StressGrowth(const StudyFamily& family, std::size_t column, StudyFigure figure) {
        const StudyColumn& scene = family.scene->columns[column];
        if (scene.what.unit != "Pa" || scene.node == no_index) return;
        std::vector<const StudyRun*> levels;
        for (const StudyRun* run : family.comparable)
            if (is_mesh(run->variant)) levels.push_back(run);
        std::ranges::sort(levels, {}, [](const StudyRun* run) { return run->variant.refine; });
        for (std::size_t i = 1; i < levels.size(); ++i) {
            const StudyRun &coarse = *levels[i - 1], &fine = *levels[i];
            const Real growth = figure_value(fine, column, figure, 0) / figure_value(coarse, column, figure, 0);
            rates.push_back(growth > 0 ? std::log2(growth) / (fine.variant.refine - coarse.variant.refine) : 0);
        }
        if (rates.empty()) return;
        constexpr Real near = 0.25;
        const StudyColumn& before = levels[levels.size() - 2]->columns[column];
        same_place = (levels.back()->columns[column].place - before.place).norm() <= near * scene.size;
    }

    bool grows(std::size_t levels) const {
        constexpr Real least_rate = 0.1;
        return same_place && rates.size() >= levels &&
               std::all_of(rates.end() - static_cast<std::ptrdiff_t>(levels), rates.end(),
                           [](Real rate) { return rate > least_rate; });
    }
    /// True for a singular stress, which has no limit for finer meshes. Its growth rates, see `rates`, stay equal when
    /// each level halves the edge length. For a converging stress each rate is 0.5 (order 1) to 0.7 (order 1/2) times
    /// the previous one.
    bool is_singular() const {
        constexpr Real least_steadiness = 0.75;
        return grows(2) && rates.back() > least_steadiness * rates[rates.size() - 2];
    }
    /// True if there are too few meshes to decide whether the stress has a limit.
    bool is_undecided() const { return rates.size() == 1 && grows(1); }
};

std::string singular_text(const StudyColumn& scene, const StressGrowth& growth) {
    return "grows " + short_text(std::exp2(growth.rates.back())) + " times with each halving of the edges, at node " +
           std::to_string(scene.node) + " " + short_text(scene.place) +
           " m. Sharp inner corners, edges of clamps and point loads have no finite stress: round the corner, spread "
           "the load, or measure the stress elsewhere";
}

std::string irregular_text(const char* part, ConvergenceShape shape) {
    if (shape == ConvergenceShape::coarse)
        return std::string("two levels of the ") + part +
               " differ by more than 30 % of the value: both are too coarse, and the error may exceed the error bar";
    const char* behaviour = shape == ConvergenceShape::oscillating ? "changes its sign"
                            : shape == ConvergenceShape::fast      ? "decreases faster than the theory predicts"
                                                                   : "does not decrease as the theory predicts";
    return std::string("the ") + part + " error " + behaviour +
           ", so the value is not extrapolated; the error bar is a multiple of the largest difference and can be used";
}

/// Sets the total error and the extrapolated value of a quantity from its convergence and the parts of its error.
void combine(MeasuredQuantity& quantity) {
    StudyQuantity& r = quantity.result;
    r.error = r.mesh + r.step + r.contact + r.noise;
    r.mesh_order = quantity.mesh.order();
    r.step_order = quantity.step.order();
    r.best = r.value;
    r.best_error = r.noise;
    const std::pair<const Convergence*, Real> parts_of_error[] = {
        {&quantity.mesh, r.mesh}, {&quantity.step, r.step}, {&quantity.contact, r.contact}};
    for (const auto& [convergence, error] : parts_of_error) {
        if (convergence->shape() == ConvergenceShape::unmeasured && error == 0) continue;  // there is no such error
        if (convergence->irregular() && error <= least_share_of_bar * r.error) {
            r.best_error += error;  // this part is not extrapolated; its whole error is added
            continue;
        }
        r.best += convergence->limit() - r.value;
        r.best_error += convergence->limit_error();
    }
    r.best_error += quantity.shape;
}

/// Enlarges the mesh error of linear elements if smoothed elements on the same mesh have a value outside the error bar.
/// Linear elements that lock converge so slowly that the differences of their meshes do not show the error.
void apply_smoothed(Real value, MeasuredQuantity& quantity) {
    constexpr Real errors_of_difference = 1.5;
    StudyQuantity& r = quantity.result;
    quantity.least_mesh = errors_of_difference * std::abs(value - r.value);
    r.error += quantity.least_mesh + quantity.shape - r.mesh;
    r.mesh = quantity.least_mesh + quantity.shape;
    r.best = r.best_error = no_value;
    r.verdict = StudyVerdict::irregular;
    r.sentence += (r.sentence.empty() ? "" : "; ") + std::string("linear elements are too stiff here: with smoothed ") +
                  "elements the value is " + short_text(value, 4) + " " + r.unit +
                  ", and the error bar is a multiple of the difference";
}

void judge(const StudyFamily& family, std::size_t column, StudyFigure figure, Real wanted_error,
           MeasuredQuantity& quantity) {
    StudyQuantity& r = quantity.result;
    const auto decide = [&r](StudyVerdict verdict, const std::string& sentence) {
        r.verdict = verdict;
        r.sentence = sentence;
    };
    const StudyColumn& scene = family.scene->columns[column];
    // `within` is above 0 only for values that vanish with tolerance or step. Values as small as rounding errors do not
    // get the verdict `zero`.
    if (const Real within = family.zero_within[column];
        std::abs(r.value) <= within && within > agreement_share * r.scale) {
        r.error = within;
        r.mesh = r.step = r.contact = r.noise = r.best = r.best_error = no_value;
        return decide(StudyVerdict::zero,
                      "a run with a lower tolerance or shorter steps has less than a third of it, so it is an error of "
                      "the contact solver or of the steps");
    }
    if (figure != StudyFigure::agreed && !scene.is_statistic && quantity.noise > agreement_share * r.scale) {
        r.error = r.mesh = r.step = r.contact = r.best = r.best_error = no_value;
        return decide(
            StudyVerdict::chaotic,
            "runs whose starts differ by 1e-12 m give different values, so this value depends on rounding errors");
    }
    const StressGrowth growth(family, column, figure);
    if (growth.is_singular()) {
        r.error = r.mesh = infinity;
        r.best = r.best_error = no_value;
        return decide(StudyVerdict::singular, singular_text(scene, growth));
    }
    if (!std::isfinite(r.value)) return decide(StudyVerdict::not_measured, "the run has no value");
    if (std::isnan(r.mesh)) {
        if (quantity.elements.empty())
            return decide(StudyVerdict::not_measured,
                          "the mesh error is unknown, because no run with another mesh has a result");
        r.mesh = 0;
        for (const auto& [variant, value] : quantity.elements) r.mesh = std::max(r.mesh, std::abs(value - r.value));
        r.mesh += quantity.shape;
        r.error = r.mesh + r.step + r.contact + r.noise;
        return decide(
            StudyVerdict::not_measured,
            "the mesh error is only guessed from other elements, because no run with another mesh has a result");
    }
    if (std::isnan(r.step))
        return decide(StudyVerdict::not_measured,
                      "the step error is unknown, because no run with other steps has a result");
    if (std::isnan(r.contact))
        return decide(StudyVerdict::not_measured,
                      "the contact error is unknown, because no run with another tolerance has a result");
    // fraction of the wanted error; an irregular part of the error (see least_share_of_bar) below it is ignored, too
    constexpr Real share_of_wanted = 0.1;
    decide(StudyVerdict::known, "");
    const auto check = [&](const char* name, const Convergence& part, Real error) {
        if (part.irregular() && error > least_share_of_bar * r.error &&
            error > share_of_wanted * wanted_error * r.scale)
            decide(StudyVerdict::irregular,
                   (r.sentence.empty() ? "" : r.sentence + "; ") + irregular_text(name, part.shape()));
    };
    if (growth.is_undecided()) {
        r.best = r.best_error = no_value;
        decide(
            StudyVerdict::irregular,
            "the stress grows from mesh to mesh, and only a third mesh shows whether it has a limit; if not, as at a "
            "sharp inner corner, the error exceeds every error bar");
    }
    check("mesh", quantity.mesh, r.mesh);
    check("step", quantity.step, r.step);
    for (const StudyRun& run : *family.all)
        if (run.variant.draw != 0 && run.status == StudyRunStatus::failed && r.sentence.empty())
            decide(StudyVerdict::irregular,
                   "a run whose start differs by 1e-12 m failed, so this scene may fail by chance");
    for (const auto& [variant, value] : quantity.elements)
        if (variant.element == ElementKind::smoothed &&
            std::abs(value - r.value) > std::max(r.error, share_of_wanted * wanted_error * r.scale))
            apply_smoothed(value, quantity);
    for (const auto& [variant, value] : quantity.elements)
        if (std::abs(value - r.value) > std::max(r.error, wanted_error * r.scale) && r.sentence.empty())
            r.sentence = "with " + std::string(name_of(*variant.element)) + " elements the value is " +
                         short_text(value, 4) + " " + r.unit + ", outside the error bar";
}

/// Estimates the error of a value, which value_of() takes from each run.
template <class ValueOf>
MeasuredQuantity measure_values(const StudyFamily& family, std::size_t column, Real scale, const ValueOf& value_of) {
    const SeriesColumn& series = family.scene->columns[column].what;
    MeasuredQuantity quantity;
    StudyQuantity& r = quantity.result;
    r.unit = series.unit;
    r.scale = scale;
    r.value = value_of(*family.scene);
    std::vector<ConvergenceLevel> mesh, step, contact;
    for (const StudyRun* run : family.comparable) {
        const StudyVariant& v = run->variant;
        const Real value = value_of(*run);
        if (is_mesh(v)) mesh.push_back({std::exp2(Real{-1} * v.refine), value});
        if (is_step(v)) step.push_back({v.step, value});
        if (is_contact(v)) contact.push_back({v.tolerance, value});
        if (v.draw != 0 && std::isfinite(value)) quantity.noise = std::max(quantity.noise, std::abs(value - r.value));
        if (v.element) quantity.elements.emplace_back(v, value);
    }
    constexpr Real rounding = 1e-9;  // assumed upper limit of the rounding errors of a run, divided by the scale
    Real noise = std::max(rounding * r.scale, quantity.noise);
    quantity.contact = Convergence(contact, {1, 1}, noise);
    // in the mesh and step errors, differences up to the error of the contact solver are noise, too
    if (contact.size() > 1) noise = std::max(noise, quantity.contact.error());
    quantity.mesh = Convergence(mesh, mesh_theory(series), noise, family.sizes[column]);
    quantity.step = Convergence(step, step_theory(*family.scene), noise, family.sizes[column]);
    r.expected_mesh_order = mesh_theory(series).least;
    r.expected_step_order = step_theory(*family.scene).least;
    // A part of the error for which the study has no runs is zero: rigid bodies have no mesh error, scenes without
    // contacts no contact error.
    const auto error = [&](const Convergence& convergence, auto belongs) {
        const bool planned = std::ranges::any_of(
            *family.all, [&](const StudyRun& run) { return belongs(run.variant) && !run.variant.is_scene(); });
        return planned ? convergence.error() : 0;
    };
    r.mesh = error(quantity.mesh, is_mesh);
    // Flat faces change a displacement, but not the constant part of a length. The error is therefore a share of the
    // size of the column (the largest change since the start), or of the value if it is smaller.
    quantity.shape = family.scene->columns[column].shape_error * std::min(std::abs(r.value), family.sizes[column]);
    r.mesh += quantity.shape;
    r.step = error(quantity.step, is_step);
    r.contact = error(quantity.contact, is_contact);
    r.noise = quantity.noise;
    combine(quantity);
    return quantity;
}

}  // namespace

StudyFamily::StudyFamily(const std::vector<StudyRun>& runs)
    : all(&runs), scene(&runs.front()), sizes(column_sizes(runs.front())) {
    const auto same_column = [](const StudyColumn& a, const StudyColumn& b) {
        return a.what.probe == b.what.probe && a.what.quantity == b.what.quantity && a.values.size() == b.values.size();
    };
    for (const StudyRun& run : runs)
        if (run.status == StudyRunStatus::ok && run.time.size() == scene->time.size() &&
            std::ranges::equal(run.columns, scene->columns, same_column))
            comparable.push_back(&run);
    find_zeros();
}

void StudyFamily::find_zeros() {
    // A column counts as zero if a shorter step or a smaller tolerance reduces its size below this share of its size in
    // the first run: its values are only errors of the steps or of the solver. For comparison, a quarter of the step
    // reduces an error of order 1 to a quarter.
    constexpr Real vanishing = 1.0 / 3;
    std::vector<Real> largest = sizes, least = sizes;
    for (const StudyRun* run : comparable) {
        const std::vector<Real> of_run = column_sizes(*run);
        const StudyVariant& v = run->variant;
        const bool is_finer = (is_step(v) && v.step < 1) || (is_contact(v) && v.tolerance < 1);
        for (std::size_t c = 0; c < sizes.size(); ++c) {
            largest[c] = std::max(largest[c], of_run[c]);
            if (is_finer) least[c] = std::min(least[c], of_run[c]);
        }
    }
    for (std::size_t c = 0; c < sizes.size(); ++c)
        zero_within.push_back(least[c] < vanishing * sizes[c] ? largest[c] : 0);
}

PerturbedRuns StudyFamily::perturbed() const {
    PerturbedRuns runs{scene, {}};
    for (const StudyRun* run : comparable)
        if (run->variant.draw != 0) runs.perturbed.push_back(run);
    return runs;
}

std::vector<Real> column_sizes(const StudyRun& run) {
    std::map<std::string, Real> largest;
    for (const StudyColumn& column : run.columns) {
        if (column.values.empty()) continue;
        const bool relative = column.what.unit == "m" || column.what.unit == "J";
        const auto known = std::ranges::find_if(column.values, [](Real value) { return std::isfinite(value); });
        const auto first = static_cast<std::size_t>(known - column.values.begin());
        Real& scale = largest[group_of(column.what)];
        for (std::size_t row = first; row < column.values.size(); ++row) {
            const Real value = std::abs(column.values[row] - (relative ? column.values[first] : 0));
            if (value > scale) scale = value;  // unknown values do not count
        }
    }
    std::vector<Real> sizes;
    for (const StudyColumn& column : run.columns) sizes.push_back(largest[group_of(column.what)]);
    return sizes;
}

std::vector<Real> column_scales(const StudyFamily& family) {
    constexpr Real rounding = 1e-9, least_share = 1e-6;
    const StudyRun& run = *family.scene;
    const PerturbedRuns perturbed = family.perturbed();
    std::vector<Real> scales = family.sizes;
    std::map<std::string, Real> of_unit;  // largest size of the columns with this unit
    std::map<std::string, Real> energy;   // largest energy of each probe [J]
    for (std::size_t c = 0; c < scales.size(); ++c) {
        const StudyColumn& column = run.columns[c];
        of_unit[column.what.unit] = std::max(of_unit[column.what.unit], scales[c]);
        if (column.what.unit != "J") continue;
        for (const Real value : column.values)
            if (std::abs(value) > energy[column.what.probe]) energy[column.what.probe] = std::abs(value);
    }
    for (std::size_t c = 0; c < scales.size(); ++c) {
        const StudyColumn& column = run.columns[c];
        const std::string& unit = column.what.unit;
        const Real least = unit == "J"
                               ? rounding * energy[column.what.probe]
                               : std::max(unit == "m" ? rounding * column.size : 0, least_share * of_unit[unit]);
        scales[c] = std::max({scales[c], least, first_difference(perturbed, c) / agreement_share});
    }
    return scales;
}

std::vector<StudyFigure> figures_of(const StudyFamily& family, std::size_t column, Real agree_until, Real scale) {
    const StudyColumn& scene = family.scene->columns[column];
    std::vector<StudyFigure> figures;
    if (agree_until < family.scene->time.back() && !scene.is_statistic &&
        std::isfinite(figure_value(*family.scene, column, StudyFigure::agreed, agree_until)))
        figures.push_back(StudyFigure::agreed);
    figures.push_back(StudyFigure::end);
    const auto value = [&](StudyFigure figure) { return figure_value(*family.scene, column, figure, 0); };
    const bool relative = scene.what.unit == "m" || scene.what.unit == "J";
    const Real start = relative && !scene.values.empty() ? scene.values[0] : 0;
    const StudyFigure extreme = value(StudyFigure::largest) - start >= start - value(StudyFigure::smallest)
                                    ? StudyFigure::largest
                                    : StudyFigure::smallest;
    // The value at the end is often the extreme value too. Then one of the two figures suffices.
    constexpr Real different = 1e-3;
    if (std::abs(value(extreme) - value(StudyFigure::end)) > different * scale) figures.push_back(extreme);
    if (scene.what.unit == "N" && figures.size() > 1) figures.push_back(StudyFigure::mean);
    return figures;
}

MeasuredQuantity measure(const StudyFamily& family, std::size_t column, StudyFigure figure, Real scale,
                         Real agree_until, Real wanted_error) {
    const SeriesColumn& series = family.scene->columns[column].what;
    const auto value_of = [&](const StudyRun& run) { return figure_value(run, column, figure, agree_until); };
    MeasuredQuantity quantity = measure_values(family, column, scale, value_of);
    StudyQuantity& r = quantity.result;
    r.name = series.probe + "." + series.quantity + ending_of(figure);
    r.agree_until = agree_until;
    judge(family, column, figure, wanted_error, quantity);
    for (const StudyRun& run : *family.all) {
        const bool comparable = std::ranges::find(family.comparable, &run) != family.comparable.end();
        r.run_values.push_back(comparable ? value_of(run) : no_value);
        r.run_errors.push_back(comparable ? error_with(quantity, run.variant) : no_value);
    }
    return quantity;
}

Real error_with(const MeasuredQuantity& quantity, const StudyVariant& variant) {
    const StudyQuantity& r = quantity.result;
    if (std::isnan(r.error) || r.verdict == StudyVerdict::singular || r.verdict == StudyVerdict::zero) return r.error;
    const auto at = [](const Convergence& convergence, Real h, Real otherwise) {
        return convergence.shape() == ConvergenceShape::unmeasured ? otherwise : convergence.error_at(h);
    };
    Real mesh = at(quantity.mesh, std::exp2(Real{-1} * variant.refine), r.mesh - quantity.shape);
    if (variant.element && quantity.mesh.shape() != ConvergenceShape::unmeasured) {
        mesh = no_value;
        for (const auto& [run, value] : quantity.elements)
            if (run.element == variant.element && run.refine == variant.refine) mesh = quantity.mesh.error_of(value);
    } else {
        mesh = std::max(mesh, quantity.least_mesh * std::exp2(Real{-1} * std::max(variant.refine, 0)));
    }
    return mesh + quantity.shape + at(quantity.step, variant.step, r.step) +
           at(quantity.contact, variant.tolerance, r.contact) + quantity.noise;
}

std::vector<Real> error_band(const StudyFamily& family, std::size_t column, Real scale, Real agree_until) {
    const StudyColumn& scene = family.scene->columns[column];
    std::vector<Real> band;
    for (std::size_t row = 0; row < scene.values.size(); ++row) {
        const bool agreed = family.scene->time[row] <= agree_until || scene.is_statistic;
        const auto value_of = [&](const StudyRun& run) { return run.columns[column].values[row]; };
        band.push_back(agreed ? measure_values(family, column, scale, value_of).result.error : no_value);
    }
    return band;
}

}  // namespace skerry
