#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "engine/output/number_text.h"
#include "engine/study/report/wording.h"
#include "skerry/study.h"

namespace skerry {

namespace {

constexpr std::size_t most_quantities = 14;  // largest number of lines with quantities
constexpr std::size_t most_remarks = 4;      // largest number of lines of each kind of remark

std::string quantity_line(const StudyQuantity& q, std::size_t width) {
    const QuantityText text = quantity_text(q);
    const auto with_space = [](const std::string& unit) { return unit.empty() ? unit : " " + unit; };
    std::string line =
        "  " + q.name + std::string(width - q.name.size(), ' ') + " = " + text.value + with_space(text.unit);
    if (q.verdict == StudyVerdict::zero) return line + "\n";
    if (text.error.empty()) return line + ", " + std::string(name_of(q.verdict)) + "\n";
    line += " +- " + text.error;
    if (!text.parts.empty()) line += " (" + (text.share.empty() ? "" : text.share + ": ") + text.parts + ")";
    // The extrapolated value is shown if its error bar is much shorter than that of the computed value.
    constexpr double much = 0.7;
    if (!text.best.empty() && q.best_error < much * q.error) line += ", best " + text.best + " +- " + text.best_error;
    if (!text.orders.empty()) line += ", " + text.orders;
    if (q.verdict != StudyVerdict::known) line += ", " + std::string(name_of(q.verdict));
    return line + "\n";
}

/// True for a component of a vector that is smaller than the wanted error of the vector.
bool is_negligible(const StudyQuantity& q, double wanted_error) {
    return q.verdict == StudyVerdict::known && std::abs(q.value) + q.error <= wanted_error * q.scale;
}

/// True for a quantity that is zero or mostly repeats another one: means over time, velocities, and sizes of forces.
bool is_minor(const StudyQuantity& q) {
    static constexpr std::array<std::string_view, 3> minor{".velocity_", ".largest_force_", ".pressing_force_"};
    return q.verdict == StudyVerdict::zero || q.name.ends_with("_mean") ||
           std::ranges::any_of(minor, [&](std::string_view part) { return q.name.find(part) != std::string::npos; });
}

/// True for a quantity that is computed from a column with statistics of all bodies.
bool is_statistic(const StudyQuantity& q, const StudyResult& result) {
    return std::ranges::any_of(result.runs.front().columns, [&](const StudyColumn& column) {
        return column.is_statistic && q.name.starts_with(column.what.probe + "." + column.what.quantity + "_");
    });
}

std::string quantities_text(const StudyResult& result) {
    std::vector<const StudyQuantity*> shown;
    std::size_t negligible = 0, width = 0;
    for (const StudyQuantity& q : result.quantities) {
        if (is_negligible(q, result.wanted_error))
            ++negligible;
        else
            shown.push_back(&q);
    }
    std::stable_partition(shown.begin(), shown.end(), [](const StudyQuantity* q) { return !is_minor(*q); });
    // Statistics of all bodies come first. The study contains them only if the scene has many bodies, or if bodies move
    // chaotically. Then they say more than the values of single bodies.
    std::stable_partition(shown.begin(), shown.end(), [&](const StudyQuantity* q) { return is_statistic(*q, result); });
    const std::size_t omitted = shown.size() > most_quantities ? shown.size() - most_quantities : 0;
    shown.resize(shown.size() - omitted);
    for (const StudyQuantity* q : shown) width = std::max(width, q->name.size());
    std::string text;
    for (const StudyQuantity* q : shown) text += quantity_line(*q, width);
    if (omitted > 0) text += "  ... and " + std::to_string(omitted) + " more, in the page\n";
    if (negligible > 0)
        text += "  ... and " + std::to_string(negligible) + (negligible > 1 ? " values" : " value") + " below " +
                percent(result.wanted_error) + " of the largest of " + (negligible > 1 ? "their" : "its") + " kind\n";
    return text;
}

/// Text of at most `most_remarks` lines, each with an indent.
std::string some_lines(const std::vector<std::string>& lines) {
    std::string text;
    for (std::size_t i = 0; i < std::min(most_remarks, lines.size()); ++i) text += "  " + lines[i] + "\n";
    if (lines.size() > most_remarks)
        text += "  ... and " + std::to_string(lines.size() - most_remarks) + " more remarks, in the page\n";
    return text;
}

std::string cheapest_text(const StudyResult& result) {
    const CheapestSettings& cheapest = *result.cheapest;
    std::string text = "cheapest settings for an error of " + percent(result.wanted_error) + ": " +
                       variant_text(cheapest.variant) + "\n";
    text += "  predicted error " + percent(cheapest.error) + ", CPU time " + duration_text(cheapest.cpu_seconds) +
            " (the scene as it is: " + duration_text(result.runs.front().cpu_seconds) + "); " + cheapest.sentence +
            "\n";
    if (!cheapest.reaches)
        text.replace(0, text.find('\n'),
                     "nearest to an error of " + percent(result.wanted_error) + ": " + variant_text(cheapest.variant));
    return text;
}

}  // namespace

std::vector<std::string> verdict_lines(const StudyResult& result) {
    struct Remark {
        const StudyQuantity* first;
        std::size_t count;
    };
    std::vector<Remark> remarks;
    for (const StudyQuantity& q : result.quantities) {
        if (q.verdict == StudyVerdict::known) continue;
        const auto found = std::ranges::find_if(remarks, [&q](const Remark& remark) {
            return remark.first->verdict == q.verdict && remark.first->sentence == q.sentence;
        });
        if (found == remarks.end())
            remarks.push_back({&q, 1});
        else
            ++found->count;
    }
    std::vector<std::string> lines;
    for (const auto& [first, count] : remarks)
        lines.push_back(std::string(name_of(first->verdict)) + ": " + first->name +
                        (count > 1 ? " and " + std::to_string(count - 1) + " more" : "") + ": " + first->sentence);
    return lines;
}

std::vector<std::string> missing_lines(const StudyResult& result) {
    std::vector<std::pair<std::string, std::string>> reasons;  // pairs (status and settings of the runs, reason)
    for (const StudyRun& run : result.runs) {
        if (run.status == StudyRunStatus::ok) continue;
        const auto found = std::ranges::find(reasons, run.message, &std::pair<std::string, std::string>::second);
        if (found != reasons.end())
            found->first += "; " + variant_text(run.variant);
        else
            reasons.emplace_back(
                (run.status == StudyRunStatus::left_out ? "left out" : std::string(name_of(run.status))) + ": " +
                    variant_text(run.variant),
                run.message);
    }
    std::vector<std::string> lines;
    for (const auto& [runs, reason] : reasons) lines.push_back(runs + ": " + reason);
    return lines;
}

std::string study_text(const StudyResult& result) {
    double cpu = 0;
    std::size_t left_out = 0, failed = 0;
    for (const StudyRun& run : result.runs) {
        if (run.status == StudyRunStatus::left_out) {
            ++left_out;
            continue;
        }
        cpu += run.cpu_seconds;
        if (run.status != StudyRunStatus::ok) ++failed;
    }
    std::string text = "study of " + result.scene + ": " + std::to_string(result.runs.size() - left_out) + " runs, " +
                       duration_text(cpu) + " of CPU time";
    if (failed > 0) text += ", " + std::to_string(failed) + " without a result";
    if (left_out > 0) text += ", " + std::to_string(left_out) + " left out";
    text += "\n" + quantities_text(result) + some_lines(verdict_lines(result));
    for (const std::string& line : missing_lines(result)) text += line + "\n";
    for (std::size_t i = 0; i < std::min(most_remarks, result.sentences.size()); ++i)
        text += result.sentences[i] + "\n";
    if (result.sentences.size() > most_remarks)
        text += "... and " + std::to_string(result.sentences.size() - most_remarks) + " more remarks, in the page\n";
    return result.cheapest ? text + cheapest_text(result) : text;
}

}  // namespace skerry
