#include "skerry/study.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <iterator>
#include <utility>

#include "engine/output/number_text.h"
#include "engine/scene/case_hash.h"
#include "engine/scene/write_scene.h"
#include "engine/study/analysis/analyse.h"
#include "engine/study/plan_study.h"
#include "engine/study/report/wording.h"
#include "engine/study/run_file.h"
#include "engine/study/run_variant.h"
#include "engine/study/study_columns.h"
#include "jobs/run_tasks.h"

namespace skerry {

namespace {

// Time between two calls of StudySettings::go_on. It is short, so that a program can react to Ctrl-C within 50 ms.
constexpr std::chrono::milliseconds watch_period{20};

constexpr double usual_budget = 15;  // default of StudySettings::budget; short studies get more, see drop_pointless()

void require_positive(const char* field, double value, const char* expected) {
    if (value > 0 && std::isfinite(value)) return;
    refuse("study", field, short_text(value), expected);
}

void check_settings(const StudySettings& settings) {
    constexpr const char* share = "a share above 0 and below 1, for example 0.05 for 5 %";
    require_positive("error", settings.error, share);
    if (settings.error >= 1) refuse("study", "error", short_text(settings.error), share);
    if (settings.budget) require_positive("budget", *settings.budget, "a number > 0");
    if (settings.seconds) require_positive("seconds", *settings.seconds, "a time > 0 (s)");
    constexpr int most_threads = 1024;
    if (settings.threads < 0 || settings.threads > most_threads)
        refuse("study", "threads", std::to_string(settings.threads),
               "a number of threads from 0 to 1024 (0: the number of cores)");
}

/// Adds a sentence for each traction whose loaded area differs on the finest meshes, because a box or a sphere selects
/// other faces there.
void add_load_sentences(const std::vector<StudyRun>& runs, std::vector<std::string>& sentences) {
    constexpr Real least_change = 0.05;
    const StudyRun* finest = &runs[0];
    for (const StudyRun& run : runs)
        if (run.status == StudyRunStatus::ok && run.variant.refine > finest->variant.refine) finest = &run;
    for (const StudyLoad& load : runs[0].loads) {
        const auto fine = std::ranges::find(finest->loads, load.name, &StudyLoad::name);
        if (fine == finest->loads.end() || std::abs(fine->area - load.area) <= least_change * load.area) continue;
        sentences.push_back("Load '" + load.name + "' acts on " + short_text(load.area) +
                            " m^2 in the scene as it is, and on " + short_text(fine->area) + " m^2 with the " +
                            variant_text(finest->variant) +
                            ", because other faces are selected there. The mesh errors include this change. To avoid "
                            "it, choose the faces by a set of the mesh, or by a box that ends where faces end.");
    }
}

/// A study that is running.
class RunningStudy {
public:
    RunningStudy(const std::filesystem::path& path, const StudySettings& settings)
        : settings_(settings),
          threads_(settings.threads > 0 ? settings.threads : core_count()),
          budget_(settings.budget.value_or(usual_budget)),
          hasher_(path),
          scene_(read_studied_scene(path, settings)),
          plan_(plan_study(scene_)),
          lock_(reserve_folder(settings.folder, path)) {
        runs_.resize(plan_.size());
        inputs_.resize(plan_.size());
        progress_ = std::vector<std::atomic<double>>(plan_.size());
    }

    StudyResult run() {
        if (settings_.redo && !settings_.folder.empty())
            for (const PlannedRun& planned : plan_) remove_run(settings_.folder, planned.variant);
        std::size_t made = make_stage(StudyStage::start, 0);
        if (!stop_ && runs_[0].status == StudyRunStatus::ok) {
            drop_pointless();
            for (const StudyStage stage : {StudyStage::basic, StudyStage::finer, StudyStage::last})
                made = make_stage(stage, made);
        }
        StudyResult result;
        result.stopped = stop_;
        if (!stop_ && runs_[0].status == StudyRunStatus::ok) {
            result = analysed();
        } else if (!stop_) {
            result.sentences.push_back("The scene itself could not be run to its end: " + runs_[0].message +
                                       ". Correct it first; no errors were determined.");
            result.runs.assign(runs_.begin(), runs_.begin() + static_cast<std::ptrdiff_t>(made));
        }
        if (!store_failure_.empty()) result.sentences.insert(result.sentences.begin(), store_failure_);
        result.scene = scene_.file.name;
        return result;
    }

private:
    /// Makes the runs of a stage, of which the first has the index `first` in `plan_`. Returns the index after the last
    /// one.
    std::size_t make_stage(StudyStage stage, std::size_t first) {
        if (stop_) return first;
        if (stage == StudyStage::last) drop_unneeded();
        const auto after = std::ranges::find_if(plan_, [&](const PlannedRun& run) { return run.stage > stage; });
        const auto end = static_cast<std::size_t>(after - plan_.begin());
        if (first > 0) {
            predict_levels(scene_, std::span(runs_).first(plan_.size()), plan_);
            keep_to_budget(budget_, threads_, first, std::span(plan_).first(end));
        }
        make_runs(first, end);
        return end;
    }

    /// Removes runs from the plan that the first run shows to be pointless: runs with other tolerances if there were no
    /// contacts, and runs with steps longer than a call of advance. Raises the default budget if the first run is
    /// short.
    void drop_pointless() {
        mean_step_ = runs_[0].time.back() / static_cast<Real>(std::max<std::uint64_t>(runs_[0].steps, 1));
        std::erase_if(plan_, [&](const PlannedRun& planned) {
            const StudyVariant& variant = planned.variant;
            return (variant.tolerance != 1 && runs_[0].max_contacts == 0) ||
                   (variant.step > 1 && variant.step * mean_step_ > scene_.longest_call * (1 + 1e-6));
        });
        constexpr double short_study = 5;  // [s]
        if (!settings_.budget) budget_ = std::max(budget_, short_study / runs_[0].cpu_seconds);
    }

    /// Removes from the plan those runs of the last stage that could not change the results.
    void drop_unneeded() {
        choose_columns_by_name(settings_.probes, scene_.path, runs_[0].columns);
        const OpenParts open = open_parts(runs_, settings_);
        std::erase_if(plan_, [&](const PlannedRun& planned) {
            return planned.stage == StudyStage::last &&
                   ((planned.variant.draw != 0 && !open.noise) || (planned.variant.step != 1 && !open.step));
        });
    }

    /// Analyses the runs, of which at least the first must have the status `ok`.
    StudyResult analysed() {
        runs_.resize(plan_.size());
        for (std::size_t i = 0; i < plan_.size(); ++i)
            if (!plan_[i].reason.empty())
                runs_[i] = {.variant = plan_[i].variant,
                            .assignments = variant_assignments(scene_, plan_[i].variant, mean_step_),
                            .status = StudyRunStatus::left_out,
                            .message = plan_[i].reason,
                            .cpu_seconds = plan_[i].cost * runs_[0].cpu_seconds};
        refuse_other_columns();
        choose_columns();
        for (std::size_t c = 0; c < scene_.shape_errors.size() && c < runs_[0].columns.size(); ++c)
            if (runs_[0].columns[c].what.unit == "m" || runs_[0].columns[c].what.unit == "Pa")
                runs_[0].columns[c].shape_error = scene_.shape_errors[c];
        StudyResult result = analyse(std::move(runs_), settings_);
        add_load_sentences(result.runs, result.sentences);
        std::ranges::move(flat_texts(scene_.flat), std::back_inserter(result.sentences));
        if (result.cheapest)
            result.cheapest->assignments = variant_assignments(scene_, result.cheapest->variant, mean_step_);
        return result;
    }

    /// Marks runs whose columns differ from those of the first run as refused, because their values cannot be compared.
    void refuse_other_columns() {
        const auto same = [](const StudyColumn& a, const StudyColumn& b) {
            return a.what.probe == b.what.probe && a.what.quantity == b.what.quantity && a.what.unit == b.what.unit;
        };
        for (StudyRun& run : runs_) {
            if (run.status != StudyRunStatus::ok || std::ranges::equal(run.columns, runs_[0].columns, same)) continue;
            run.status = StudyRunStatus::refused;
            run.message = "it has other columns than the run of the scene as it is";
            run.columns.clear();
            run.time.clear();
        }
    }

    /// True if a run has a value other than zero in the column.
    bool has_values(std::size_t column) const {
        return std::ranges::any_of(runs_, [&](const StudyRun& run) {
            return run.columns.size() == runs_[0].columns.size() &&
                   std::ranges::any_of(run.columns[column].values,
                                       [](Real value) { return std::isfinite(value) && value != 0; });
        });
    }

    /// Selects the reported columns. Without names of probes, columns that are zero in all runs are left out, such as
    /// contact forces of bodies that touch nothing.
    void choose_columns() {
        for (StudyRun& run : runs_) {
            if (run.columns.size() != runs_[0].columns.size()) continue;  // the run is left out or was refused
            choose_columns_by_name(settings_.probes, scene_.path, run.columns);
            for (std::size_t c = 0; c < run.columns.size() && settings_.probes.empty(); ++c)
                run.columns[c].reported &= has_values(c);
        }
    }

    std::string inputs_of(std::size_t i, CaseHasher& hasher) const {
        std::string inputs = hasher.hash(runs_[i].assignments) + " version " + SKERRY_VERSION;
        if (plan_[i].variant.draw != 0) inputs += " draw " + std::to_string(plan_[i].variant.draw);
        return inputs;
    }

    /// Reads run `i` from the folder. Returns true if the folder holds this run and the run has a result. Throws
    /// SceneError if the file of the run holds something else.
    bool read_stored(std::size_t i) {
        if (settings_.folder.empty()) return false;
        StoredRun stored = read_run(settings_.folder, inputs_[i], plan_[i].variant);
        if (!stored.found.empty())
            refuse_in(settings_.folder.string(), "study", "folder", stored.found,
                      "runs of " + scene_.path.string() + " in its present version, with these settings",
                      "choose another folder, or redo to replace runs of studies");
        if (!stored.run || stored.run->status == StudyRunStatus::refused) return false;
        runs_[i] = std::move(*stored.run);
        return true;
    }

    /// Makes the runs with indices from `first` to `end` - 1 that are neither left out nor stored in the folder. Long
    /// runs are made first, one by one with all threads; then the others at the same time.
    void make_runs(std::size_t first, std::size_t end) {
        std::vector<std::size_t> unfinished;
        for (std::size_t i = first; i < end; ++i) {
            if (!plan_[i].reason.empty()) continue;
            runs_[i].assignments = variant_assignments(scene_, plan_[i].variant, mean_step_);
            inputs_[i] = inputs_of(i, hasher_);
            if (read_stored(i))
                finish(i);
            else
                unfinished.push_back(i);
        }
        std::ranges::stable_sort(unfinished, std::greater(), [&](std::size_t i) { return plan_[i].cost; });
        double total = 0;
        for (const std::size_t i : unfinished) total += plan_[i].cost;
        auto begin = unfinished.begin();
        for (; begin != unfinished.end() && gets_all_threads(plan_[*begin].cost, total, threads_) && !stop_; ++begin) {
            total -= plan_[*begin].cost;
            run_together({begin, begin + 1}, threads_);
        }
        if (begin != unfinished.end() && !stop_) run_together({begin, unfinished.end()}, 1);
    }

    /// Makes runs at the same time, each with this number of threads.
    void run_together(std::span<const std::size_t> numbers, int threads_of_run) {
        run_tasks(
            static_cast<Index>(numbers.size()), threads_ / threads_of_run,
            [&](Index task) {
                try {
                    make_run(numbers[static_cast<std::size_t>(task)], threads_of_run);
                } catch (...) {
                    stop_ = true;
                    throw;
                }
            },
            watch_period, [&] { watch(); });
    }

    /// Throws SceneError if the files of the scene have changed since the study began.
    void require_unchanged(std::size_t i) const {
        CaseHasher now(scene_.path);
        if (inputs_of(i, now) == inputs_[i]) return;
        refuse_in(scene_.path.string(), "study", "scene",
                  "that the scene or one of its files changed while the study ran", "the same content for all runs",
                  "runs that ended before the change are kept; undo the change to continue, or begin again");
    }

    void make_run(std::size_t i, int threads_of_run) {
        if (stop_) return;
        ++running_;
        VariantJob job{.scene = scene_.path, .overrides = {.threads = threads_of_run}, .variant = plan_[i].variant};
        if (threads_of_run == 1) job.overrides.backend = Backend::serial;
        job.overrides.assignments = runs_[i].assignments;
        job.overrides.fill_python = settings_.fill_python;
        require_unchanged(i);
        const bool completed = run_variant(job, stop_, progress_[i], runs_[i]);
        --running_;
        if (!completed) return;
        require_unchanged(i);
        store(i);
        finish(i);
    }

    /// Writes the run into the folder. If this is impossible, the study continues, because its results do not need the
    /// files.
    void store(std::size_t i) {
        // A refused run is not stored, so that the next study tries it again: a program may have been missing, or
        // memory short.
        if (settings_.folder.empty() || runs_[i].status == StudyRunStatus::refused) return;
        try {
            write_run(settings_.folder, inputs_[i], runs_[i]);
        } catch (const SceneError& error) {
            if (!store_failed_.exchange(true))
                store_failure_ = std::string("Not all runs could be stored in the folder: ") + error.what() + ".";
        }
    }

    void finish(std::size_t i) {
        progress_[i] = 1;
        ++done_;
    }

    void watch() {
        if (!settings_.go_on || stop_) return;
        StudyProgress progress{.runs_done = done_, .runs_running = running_};
        double cost = 0, done = 0;
        for (std::size_t i = 0; i < plan_.size(); ++i) {
            if (!plan_[i].reason.empty()) continue;
            ++progress.runs;
            cost += plan_[i].cost;
            done += plan_[i].cost * progress_[i];
        }
        // Before the first run has ended, the plan still contains runs that will not fit into the budget, so the total
        // cost is limited by the budget.
        progress.share = std::min(1.0, done / std::min(cost, budget_ * threads_));
        try {
            if (!settings_.go_on(progress)) stop_ = true;
        } catch (...) {
            stop_ = true;
            throw;
        }
    }

    const StudySettings& settings_;
    const int threads_;
    double budget_;
    CaseHasher hasher_;  // constructed before `scene_`, so that it detects changes of files since the scene was read
    const StudiedScene scene_;
    std::vector<PlannedRun> plan_;
    const OutputLock lock_;  // constructed after `scene_`, so that an invalid scene creates no folder
    Real mean_step_ = 0;     // mean step of the unchanged scene [s]
    // The following three vectors are indexed like `plan_`.
    std::vector<StudyRun> runs_;
    std::vector<std::string> inputs_;            // texts that identify all inputs of a run
    std::vector<std::atomic<double>> progress_;  // simulated share of each run's duration, from 0 to 1
    std::atomic<bool> store_failed_{false};
    std::string store_failure_;  // message about the first run that could not be stored; empty if there is none
    std::atomic<int> done_{0}, running_{0};
    std::atomic<bool> stop_{false};
};

}  // namespace

StudyResult study(const std::filesystem::path& scene, const StudySettings& settings) {
    check_settings(settings);
    return RunningStudy(scene, settings).run();
}

void write_cheapest_scene(const std::filesystem::path& scene, const StudyResult& result,
                          const std::filesystem::path& file) {
    if (!result.cheapest || !result.cheapest->reaches)
        refuse_in(scene.string(), "study", "error",
                  result.cheapest ? percent(result.wanted_error) + ", which no settings reach"
                                  : "no quantity with a known error",
                  result.cheapest ? "at least " + percent(result.cheapest->error) : "a quantity with a known error");
    write_scene(file, scene, result.cheapest->assignments);
}

}  // namespace skerry
