// Error bars, orders, verdicts and cheapest settings of studies with known limits.
#include "engine/study/analysis/analyse.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <random>

#include "engine/study/analysis/convergence.h"

namespace skerry::test::study_analysis_test {

namespace {

/// Values of the columns of a manufactured run at a time.
using Model = std::function<std::vector<Real>(const StudyVariant&, Real time)>;

constexpr Real limit = -0.1;  // limit of the values of made_of [m]

Real edge(const StudyVariant& variant) {
    return std::exp2(Real{-1} * variant.refine);
}

std::vector<StudyRun> runs_of(const std::vector<StudyColumn>& columns, const std::vector<StudyVariant>& variants,
                              const Model& model, int rows = 11) {
    std::vector<StudyRun> runs;
    for (const StudyVariant& variant : variants) {
        StudyRun run;
        run.variant = variant;
        run.columns = columns;
        run.cpu_seconds = std::pow(edge(variant), -4) / variant.step;
        for (int row = 0; row < rows; ++row) {
            run.time.push_back(0.1 * row);
            const std::vector<Real> values = model(variant, run.time.back());
            for (std::size_t c = 0; c < columns.size(); ++c) run.columns[c].values.push_back(values[c]);
        }
        runs.push_back(run);
    }
    return runs;
}

StudyColumn column(const char* quantity, const char* unit, const char* probe = "tip") {
    return {.what = {probe, quantity, unit}, .size = 1};
}

const std::vector<StudyVariant> all_variants{
    {}, {.refine = 1}, {.refine = -1}, {.step = 0.5}, {.step = 0.25}, {.tolerance = 0.01}, {.draw = 1}, {.draw = 2}};

/// A displacement that grows linearly in time, with errors `mesh` h^p, `step` s^q and `contact` tolerance.
std::vector<StudyRun> displacement_runs(Real mesh, Real p, Real step, Real q, Real contact) {
    return runs_of({column("displacement_z", "m")}, all_variants, [=](const StudyVariant& v, Real t) {
        return std::vector<Real>{
            limit * t * (1 + mesh * std::pow(edge(v), p) + step * std::pow(v.step, q) + contact * v.tolerance)};
    });
}

StudyQuantity only_quantity(const StudyResult& result) {
    REQUIRE(result.quantities.size() == 1);
    return result.quantities[0];
}

}  // namespace

TEST_CASE("an error bar has the parts and orders of its runs", "[unit][study]") {
    const StudyQuantity q = only_quantity(analyse(displacement_runs(-0.2, 2, 0.05, 1, 0.001), {}));
    CHECK(q.name == "tip.displacement_z_end");
    CHECK(q.verdict == StudyVerdict::known);
    CHECK(q.mesh_order == Approx(2));
    CHECK(q.step_order == Approx(1));
    const Real safety = 1.5;
    CHECK(q.mesh == Approx(safety * 0.2 * 0.1));
    CHECK(q.step == Approx(safety * 0.05 * 0.1));
    CHECK(q.contact == Approx(safety * 0.001 * 0.1));
    CHECK(q.error == Approx(q.mesh + q.step + q.contact));
    CHECK(std::abs(q.best - limit) < 1e-4 * q.error);
    CHECK(q.best_error < 0.5 * q.error);
}

TEST_CASE("error bars hold the true error and are not much longer", "[unit][study]") {
    // Errors have two terms and noise. The second term is up to 60 % of the first one on the coarsest level.
    std::mt19937 random(7);
    const auto between = [&random](Real low, Real high) {
        return std::uniform_real_distribution<Real>(low, high)(random);
    };
    struct Case {
        std::vector<Real> family;
        Real least_close;  // least share of error bars of at most three true errors
    };
    for (const auto& [family, least_close] :
         {Case{{2, 1, 0.5}, 0.9}, Case{{1, 0.5}, 0.9}, Case{{1, 0.5, 0.25}, 0.9}, Case{{4, 2, 1}, 0.7}}) {
        int held = 0, close = 0;
        constexpr int count = 2000;
        for (int i = 0; i < count; ++i) {
            const Real p = between(1, 2), next = between(-0.6, 0.6) / family[0];
            std::vector<ConvergenceLevel> levels;
            Real error = 0;
            for (const Real h : family) {
                const Real value = std::pow(h, p) * (1 + between(-0.05, 0.05)) + next * std::pow(h, p + 1);
                levels.push_back({h, value});
                if (h == 1) error = std::abs(value);
            }
            const Convergence convergence(levels, {2, 2}, 0);
            if (convergence.error() >= error) ++held;
            if (convergence.error() <= 3 * error) ++close;
        }
        CAPTURE(family, held, close);
        CHECK(held >= 0.95 * count);
        CHECK(close >= least_close * count);
    }
}

TEST_CASE("differences that do not fall as the theory says give a long bar and no extrapolation", "[unit][study]") {
    struct Case {
        std::vector<Real> values;  // with edges 2, 1 and 1/2
        ConvergenceShape shape;
        Real least_error;
    };
    for (const auto& [values, shape, least_error] :
         {Case{{1.0, 0.8, 0.65}, ConvergenceShape::slow, 0.6},        // order 0.4: the limit may be at 0.2
          Case{{1.0, 0.9, 0.7}, ConvergenceShape::slow, 0.7},         // differences that grow
          Case{{1.0, 0.8, 0.9}, ConvergenceShape::oscillating, 0.2},  // opposite signs
          Case{{1.0, 0.2, 0.199}, ConvergenceShape::fast, 0.05}}) {   // order 9.6: an accident
        CAPTURE(values);
        const Convergence convergence({{2, values[0]}, {1, values[1]}, {0.5, values[2]}}, {2, 2}, 0);
        CHECK(convergence.shape() == shape);
        CHECK(convergence.irregular());
        CHECK(convergence.error() >= least_error);
        CHECK(std::isnan(convergence.limit()));
    }
    const StudyQuantity q = only_quantity(analyse(displacement_runs(-0.2, 0.4, 0, 1, 0), {}));
    CHECK(q.verdict == StudyVerdict::irregular);
    CHECK(q.sentence ==
          "the mesh error does not decrease as the theory predicts, so the value is not extrapolated; the error bar is "
          "a multiple of "
          "the largest difference and can be used");
    CHECK(q.mesh_order == Approx(0.4));
    CHECK(q.expected_mesh_order == 2);
    CHECK(q.error > 0.2 * 0.1);
    CHECK(std::isnan(q.best));
}

TEST_CASE("the bars of meshes that lock hold the error while differences grow", "[unit][study]") {
    for (const Real stiffening : {5, 12, 30, 60}) {  // excess of stiffness on the mesh of the scene
        const auto value = [stiffening](Real h) { return 1 / (1 + stiffening * h * h); };
        const Convergence convergence({{1, value(1)}, {0.5, value(0.5)}, {0.25, value(0.25)}}, {2, 2}, 0, value(1));
        CAPTURE(stiffening);
        CHECK(convergence.shape() == ConvergenceShape::coarse);
        CHECK(convergence.error() > 1 - value(1));
        CHECK(convergence.error() < 3 * (1 - value(1)));
    }
}

TEST_CASE("a change of the sign by a second term of the error leaves a bar that is not much longer", "[unit][study]") {
    // The difference of the coarser two levels has another sign than that of the finer two.
    const auto value = [](Real h) { return h * h - 0.6 * h * h * h; };
    const Convergence convergence({{2, value(2)}, {1, value(1)}, {0.5, value(0.5)}}, {2, 2}, 0);
    CHECK(convergence.shape() == ConvergenceShape::oscillating);
    CHECK(convergence.error() > std::abs(value(1)));
    CHECK(convergence.error() < 3 * std::abs(value(1)));
}

TEST_CASE("further perturbations and steps are needed only if they would change an error bar", "[unit][study]") {
    const auto open = [](Real mesh, Real step, Real noise) {
        return open_parts(
            runs_of({column("displacement_z", "m")}, {{}, {.refine = 1}, {.step = 0.5}, {.draw = 1}},
                    [&](const StudyVariant& v, Real t) {
                        return std::vector<Real>{limit * t * (1 + mesh * edge(v) + step * v.step + noise * v.draw)};
                    }),
            {.error = 0.01});
    };
    CHECK_FALSE((open(0, 1e-4, 0).step || open(0, 0, 1e-5).noise));
    CHECK(open(0, 0.01, 0).step);
    CHECK_FALSE(open(0.2, 0.01, 0).step);  // a twentieth of the error bar
    CHECK(open(0, 0, 1e-3).noise);
}

TEST_CASE("two meshes that differ by more than 30 % of the value are both too coarse", "[unit][study]") {
    const auto with = [](Real of_fine) {
        return only_quantity(
            analyse(runs_of({column("displacement_z", "m")}, {{}, {.refine = 1}, {.step = 0.5}, {.step = 0.25}},
                            [&](const StudyVariant& v, Real t) {
                                return std::vector<Real>{limit * t * (v.refine == 1 ? of_fine : 1)};
                            }),
                    {}));
    };
    CHECK(with(1.25).verdict == StudyVerdict::known);
    const StudyQuantity coarse = with(1.4);
    CHECK(coarse.verdict == StudyVerdict::irregular);
    CHECK(coarse.sentence.find("both are too coarse") != std::string::npos);
    CHECK(coarse.error >= 0.14 - 1e-12);  // the larger value
    CHECK(std::isnan(coarse.best));
    CHECK(coarse.run_errors[1] >= 0.14 - 1e-12);
}

TEST_CASE("linear elements that lock have the error that smoothed elements show", "[unit][study]") {
    std::vector<StudyRun> runs = displacement_runs(-0.01, 2, 0, 1, 0);
    const auto add = [&runs](ElementKind kind, Real ratio) {
        runs.push_back(runs[0]);
        runs.back().variant.element = kind;
        for (Real& value : runs.back().columns[0].values) value *= ratio;
    };
    add(ElementKind::linear, 0.5);  // linear elements say nothing of smoothed ones
    CHECK(only_quantity(analyse(runs, {})).verdict == StudyVerdict::known);
    runs.back().variant.element = ElementKind::smoothed;
    const StudyResult result = analyse(runs, {});
    const StudyQuantity locked = only_quantity(result);
    CHECK(locked.verdict == StudyVerdict::irregular);
    CHECK(locked.sentence.find("linear elements are too stiff here") != std::string::npos);
    CHECK(locked.error == Approx(1.5 * 0.5 * 0.99 * 0.1));
    CHECK(locked.run_errors[0] == Approx(locked.error));
    CHECK_FALSE(result.cheapest->reaches);
}

TEST_CASE("the error of flat faces is part of every mesh error", "[unit][study]") {
    std::vector<StudyRun> runs = displacement_runs(-0.2, 2, 0, 1, 0);
    const Real without = only_quantity(analyse(runs, {})).mesh;
    runs[0].columns[0].shape_error = 0.03;
    const StudyQuantity q = only_quantity(analyse(runs, {}));
    CHECK(q.mesh == Approx(without + 0.03 * 0.8 * 0.1));
    CHECK(q.run_errors[1] > 0.03 * 0.8 * 0.1);
    CHECK(q.best_error > 0.03 * 0.8 * 0.1);
}

TEST_CASE("an irregular order of a negligible part does not matter", "[unit][study]") {
    CHECK(only_quantity(analyse(displacement_runs(-1e-5, 0.1, 0, 1, 0), {})).verdict == StudyVerdict::known);
    CHECK(only_quantity(analyse(displacement_runs(-0.2, 2, 1e-5, 0.1, 0), {})).verdict == StudyVerdict::known);
}

TEST_CASE("differences below the error of the contact solver have no order", "[unit][study]") {
    const StudyQuantity q = only_quantity(analyse(displacement_runs(1e-4, 0.1, -1e-5, 0.2, 0.02), {}));
    CHECK(std::isnan(q.mesh_order));
    CHECK(q.verdict == StudyVerdict::known);
    CHECK(q.contact == Approx(1.5 * 0.02 * 0.1));
}

TEST_CASE("differences of rounding size have no order", "[unit][study]") {
    const StudyQuantity q = only_quantity(analyse(displacement_runs(1e-15, 0.1, -1e-15, 0.2, 1e-16), {}));
    CHECK(q.verdict == StudyVerdict::known);
    CHECK(std::isnan(q.mesh_order));
    CHECK(q.error < 1e-13);
}

TEST_CASE("errors of a small component are relative to its vector", "[unit][study]") {
    const StudyResult result = analyse(
        runs_of({column("displacement_x", "m"), column("displacement_z", "m"), column("force_x", "N", "floor")},
                all_variants,
                [](const StudyVariant& v, Real t) {
                    return std::vector<Real>{1e-6 * edge(v) * t, limit * t * (1 + 0.001 * edge(v) * edge(v)), 0};
                }),
        {});
    REQUIRE(result.quantities.size() == 3);
    CHECK(result.quantities[0].scale == Approx(0.1).epsilon(0.01));
    CHECK(result.quantities[0].verdict == StudyVerdict::known);
    CHECK(result.quantities[2].error == 0);
    REQUIRE(result.cheapest);
    CHECK(result.cheapest->variant.refine == -1);  // the error of half of x would need finer meshes
}

TEST_CASE("a quantity that swings has its largest value beside that at the end", "[unit][study]") {
    const StudyResult result =
        analyse(runs_of(
                    {column("displacement_x", "m")}, all_variants,
                    [](const StudyVariant& v, Real t) {
                        return std::vector<Real>{std::sin(4 * t * (1 + 0.1 * edge(v) * edge(v))) * 0.1};
                    },
                    101),
                {});
    REQUIRE(result.quantities.size() == 2);
    CHECK(result.quantities[0].name == "tip.displacement_x_end");
    CHECK(result.quantities[1].name == "tip.displacement_x_min");
    CHECK(result.quantities[1].error < 0.1 * result.quantities[0].error);  // the phase does not matter
}

TEST_CASE("a stress that grows with every level is singular, one that converges slowly is not", "[unit][study]") {
    std::vector<StudyVariant> variants = all_variants;
    const auto stress = [&variants](const std::function<Real(Real)>& of_edge) {
        StudyColumn largest = column("largest_von_mises", "Pa");
        largest.node = 12;
        largest.place = {0, 0.1, 0};
        return only_quantity(analyse(
            runs_of({largest}, variants,
                    [&](const StudyVariant& v, Real t) { return std::vector<Real>{1e6 * t * of_edge(edge(v))}; }),
            {}));
    };
    // The angle of the solid at a re-entrant corner of an L is 270 degrees (Williams 1952).
    const StudyQuantity corner = stress([](Real h) { return 0.5 + std::pow(h, -0.4555); });
    CHECK(corner.verdict == StudyVerdict::singular);
    CHECK(corner.sentence.find("1.2") != std::string::npos);
    CHECK(corner.sentence.find("node 12 (0, 0.1, 0) m") != std::string::npos);
    CHECK(corner.error == infinity);
    CHECK(stress([](Real h) { return 1 / (h * h); }).verdict == StudyVerdict::singular);  // a point load
    CHECK(stress([](Real h) { return 1 - 0.4 * h; }).verdict == StudyVerdict::known);
    CHECK(stress([](Real h) { return h == 2 ? 1.0 : h == 1 ? 0.8 : 0.9; }).verdict == StudyVerdict::irregular);
    CHECK(stress([](Real h) { return 1 - 0.6 * std::sqrt(h); }).verdict != StudyVerdict::singular);
    // With two meshes both look alike.
    std::erase(variants, StudyVariant{.refine = -1});
    for (const StudyQuantity& q :
         {stress([](Real h) { return 0.5 + std::pow(h, -0.4555); }), stress([](Real h) { return 1 - 0.3 * h; })}) {
        CHECK(q.verdict == StudyVerdict::irregular);
        CHECK(q.sentence.find("only a third mesh shows whether it has a limit") != std::string::npos);
        CHECK(std::isnan(q.best));
    }
    CHECK(stress([](Real h) { return 1 + 0.1 * h; }).verdict == StudyVerdict::known);
}

TEST_CASE("a chaotic scene has single values until its runs part, and statistics", "[unit][study]") {
    // The logistic map with the factor 4 doubles differences in each step, in the mean (Ulam and von Neumann 1947).
    constexpr int bodies = 40, rows = 61;
    std::vector<StudyColumn> columns;
    for (int i = 0; i < bodies; ++i) columns.push_back(column("displacement_x", "m", "ball"));
    columns[1].what.probe = "bodies";  // the name of a body makes it no statistic
    columns.push_back(column("displacement_x_mean", "m", "bodies"));
    columns.back().is_statistic = true;
    for (int i = 2; i < bodies; ++i) columns[static_cast<std::size_t>(i)].reported = false;
    const auto map = [](const StudyVariant& v, Real t) {
        std::vector<Real> values;
        Real sum = 0;
        for (int i = 0; i < bodies; ++i) {
            Real x = 0.1 + 0.017 * i + 1e-12 * v.draw + 1e-5 * edge(v) * edge(v) * (v.refine != 0);
            for (int row = 0; row < std::lround(10 * t); ++row) x = 4 * x * (1 - x);
            values.push_back(x);
            sum += x / bodies;
        }
        values.push_back(sum);
        return values;
    };
    const StudyResult result = analyse(runs_of(columns, all_variants, map, rows), {});
    const Real doublings = std::log2(1e-3 / 1e-12) / 10;  // time of growth to the share of agreement [s]
    CHECK(result.agree_until > 0.7 * doublings);
    CHECK(result.agree_until < 1.1 * doublings);
    CHECK(result.growth_rate == Approx(10 * std::log(2)).epsilon(0.15));
    const auto named = [&result](const char* name) {
        const auto found = std::ranges::find(result.quantities, std::string(name), &StudyQuantity::name);
        REQUIRE(found != result.quantities.end());
        return *found;
    };
    CHECK(named("ball.displacement_x_end").verdict == StudyVerdict::chaotic);
    CHECK(std::isnan(named("ball.displacement_x_end").error));
    CHECK(named("ball.displacement_x_agreed").verdict != StudyVerdict::chaotic);
    CHECK(named("bodies.displacement_x_end").verdict == StudyVerdict::chaotic);
    const StudyQuantity mean = named("bodies.displacement_x_mean_end");
    CHECK(mean.verdict != StudyVerdict::chaotic);
    CHECK(std::abs(mean.value - 0.5) < mean.error);  // the map's mean is 1/2
    CHECK(mean.error < 0.5);
    CHECK(result.sentences.at(0).find("agree until") != std::string::npos);
}

TEST_CASE("a small difference that does not grow is part of the error bar", "[unit][study]") {
    const StudyQuantity q = only_quantity(
        analyse(runs_of({column("displacement_z", "m")}, all_variants,
                        [](const StudyVariant& v, Real t) {
                            return std::vector<Real>{limit * t * (1 + 0.01 * edge(v) * edge(v) + 2e-4 * v.draw)};
                        }),
                {}));
    CHECK(q.verdict == StudyVerdict::known);
    CHECK(q.noise == Approx(4e-4 * 0.1));
    CHECK(q.error == Approx(q.mesh + q.noise));
}

TEST_CASE("the rounding stress and constant energy of a free body are no results", "[unit][study]") {
    StudyColumn stress = column("largest_von_mises", "Pa");
    stress.node = 25;
    const std::vector<StudyColumn> columns{column("displacement_z", "m"), stress, column("kinetic", "J", "energy")};
    const StudyResult result = analyse(runs_of(columns, all_variants,
                                               [](const StudyVariant& v, Real t) {
                                                   const Real rounding =
                                                       6e-11 * t * std::pow(edge(v), -1) + 3e-6 * v.draw * (t < 0.5);
                                                   return std::vector<Real>{t, rounding, 0.5 * (1 + 1e-16 * t)};
                                               }),
                                       {});
    CHECK(only_quantity(result).name == "tip.displacement_z_end");
    CHECK(result.cheapest->reaches);
}

TEST_CASE("a small load has the relative errors of a large one", "[unit][study]") {
    // The column's body has a size of 1 m.
    const auto share = [](Real size) {
        std::vector<StudyRun> runs = displacement_runs(-0.2, 2, 0.05, 1, 0.001);
        for (StudyRun& run : runs)
            for (Real& value : run.columns[0].values) value *= size;
        const StudyResult result = analyse(runs, {.error = 0.3});
        const StudyQuantity q = only_quantity(result);
        CHECK(result.cheapest->variant == StudyVariant{.refine = 1});
        return q.error / q.scale;
    };
    CHECK(share(1e-6) == Approx(share(1)));
}

TEST_CASE("a moment that is an error of the contact solver is zero, and without a share", "[unit][study]") {
    const std::vector<StudyColumn> columns{column("displacement_z", "m"),      column("moment_x", "N m", "table"),
                                           column("moment_y", "N m", "table"), column("moment_x", "N m", "hand"),
                                           column("kinetic", "J", "energy"),   column("displacement_x", "m", "foot")};
    const StudyResult result = analyse(runs_of(columns, all_variants,
                                               [](const StudyVariant& v, Real t) {
                                                   const Real solver = 8e-6 * v.tolerance * v.step * edge(v);
                                                   const Real hand = 2e-6 * t * (1 + 0.4 * v.tolerance);
                                                   return std::vector<Real>{t,    solver * t,     -0.1 * solver,
                                                                            hand, 1 + solver * t, 1e-15 * t * v.step};
                                               }),
                                       {.error = 0.7});
    std::size_t zeros = 0;
    for (const StudyQuantity& q : result.quantities) {
        CHECK((q.verdict == StudyVerdict::zero) == q.name.starts_with("table."));
        if (q.verdict != StudyVerdict::zero) continue;
        ++zeros;
        CHECK(q.error == Approx(16e-6));  // the value on the coarser mesh
    }
    REQUIRE(zeros == 2);
    CHECK(result.cheapest->reaches);  // zeros do not count
    CHECK_THAT(study_text(result), Catch::Contains("table.moment_x_end     = zero within 16 uN m\n"));
}

TEST_CASE("an error that no run shows is not measured", "[unit][study]") {
    std::vector<StudyRun> runs = displacement_runs(-0.2, 2, 0.05, 1, 0.001);
    for (StudyRun& run : runs)
        if (run.variant.refine != 0) {
            run.status = StudyRunStatus::left_out;
            run.message = "it would take 3 h";
        }
    const StudyQuantity q = only_quantity(analyse(runs, {}));
    CHECK(q.verdict == StudyVerdict::not_measured);
    CHECK(q.sentence == "the mesh error is unknown, because no run with another mesh has a result");
    CHECK(std::isnan(q.error));
    // Another kind of element gives an idea of the error.
    runs.push_back(runs[0]);
    runs.back().variant.element = ElementKind::linear;
    for (Real& value : runs.back().columns[0].values) value *= 1.1;
    CHECK(only_quantity(analyse(runs, {})).mesh == Approx(0.1 * 0.085).epsilon(0.01));
}

TEST_CASE("a scene that fails after a tiny perturbation has no known values", "[unit][study]") {
    std::vector<StudyRun> runs = displacement_runs(-0.2, 2, 0.05, 1, 0.001);
    runs[6].status = StudyRunStatus::failed;
    const StudyQuantity q = only_quantity(analyse(runs, {}));
    CHECK(q.verdict == StudyVerdict::irregular);
    CHECK(q.sentence.find("a run whose start differs by 1e-12 m failed") != std::string::npos);
}

TEST_CASE("runs that failed or differ in their rows are not evaluated", "[unit][study]") {
    std::vector<StudyRun> runs = displacement_runs(-0.2, 2, 0.05, 1, 0.001);
    runs[1].status = StudyRunStatus::failed;
    runs[1].message = "body 'arm': an element inverted";
    const StudyQuantity q = only_quantity(analyse(runs, {}));
    CHECK(std::isnan(q.mesh_order));
    CHECK(q.mesh > 0);  // the coarser mesh is left
    runs[2].time.pop_back();
    const StudyResult result = analyse(runs, {});
    CHECK(result.sentences.back() ==
          "Run 2 is not used: its columns or its number of rows differ from those of the scene as it is.");
    CHECK(only_quantity(result).verdict == StudyVerdict::not_measured);
}

TEST_CASE("the cheapest settings are those that a search over the model finds", "[unit][study]") {
    // error 0.2 h^2 + 0.02 s, cost h^-4 / s: one finer level reaches 10 %, two finer levels reach 5 %
    const auto best = [](double wanted) {
        const auto found = analyse(displacement_runs(-0.2, 2, 0.02, 1, 0), {.error = wanted}).cheapest;
        REQUIRE(found);
        return *found;
    };
    CHECK(best(0.5).variant == StudyVariant{});
    CHECK(best(0.5).cpu_seconds == Approx(1));
    const CheapestSettings ten = best(0.13);
    CHECK(ten.reaches);
    CHECK(ten.variant == StudyVariant{.refine = 1});
    CHECK(ten.cpu_seconds == Approx(16));
    const CheapestSettings five = best(0.05);  // predicted: 1.5 (0.2/16 + 0.02) = 0.049 of a scale of 0.82
    CHECK(five.variant == StudyVariant{.refine = 2, .step = 0.5});
    CHECK(five.cpu_seconds == Approx(512));
    // Clocks are not exact: a lower tolerance is no gain if its run took less time.
    std::vector<StudyRun> runs = displacement_runs(-0.2, 2, 0.02, 1, 0);
    runs[5].cpu_seconds *= 0.98;
    CHECK(analyse(runs, {.error = 0.5}).cheapest->variant == StudyVariant{});
    // Linear elements take less time on the same mesh, and are chosen if their error is small enough.
    runs = displacement_runs(-0.05, 2, 0, 1, 0);
    runs.push_back(runs[0]);
    runs.back().variant.element = ElementKind::linear;
    runs.back().cpu_seconds = 0.4;
    for (Real& value : runs.back().columns[0].values) value *= 0.97;
    CHECK(analyse(runs, {.error = 0.2}).cheapest->variant == StudyVariant{.element = ElementKind::linear});
    CHECK(analyse(runs, {.error = 0.1}).cheapest->variant == StudyVariant{});
    const CheapestSettings none = best(1e-4);
    CHECK_FALSE(none.reaches);
    CHECK(none.variant == StudyVariant{.refine = 1, .step = 0.5});  // a quarter of the step gains less than a tenth
    CHECK(none.sentence.find("no settings reach 0.01 %") != std::string::npos);
}

}  // namespace skerry::test::study_analysis_test
