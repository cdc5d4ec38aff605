#include "skerry/recorder.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <system_error>
#include <utility>

#include "engine/base/complaint.h"
#include "engine/base/write_file.h"
#include "engine/output/series/follow_point.h"
#include "engine/output/series/probe_columns.h"
#include "engine/output/vtk/vtk_file.h"

namespace skerry {

namespace {

constexpr Real slack = 1e-9;  // tolerance for rounding errors of summed times, as a fraction of the time between rows

/// Returns the text as a CSV field, in quotes if RFC 4180 requires them.
std::string csv_field(const std::string& text) {
    if (text.find_first_of(",\"") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + "\"";
}

std::string csv_head(const std::vector<SeriesColumn>& columns) {
    std::string line;
    for (const SeriesColumn& column : columns) line += (line.empty() ? "" : ",") + csv_field(column.heading());
    return line + "\n";
}

/// Returns a row as a line of CSV. The first value is the time, whose last digits are rounding errors of a sum over all
/// steps. They are left out.
std::string csv_row(std::span<const Real> values) {
    char time[32];
    std::snprintf(time, sizeof time, "%.14g", values.front());
    std::string line = time;
    for (const Real value : values.subspan(1)) line += "," + (std::isfinite(value) ? number_text(value) : "nan");
    return line + "\n";
}

/// Returns the rows of an existing CSV file that are complete and have times up to `until` [s]. The file must have the
/// headings `head`. Returns nothing if the file cannot be read or is empty.
std::string rows_to_keep(const std::filesystem::path& file, const std::string& head, Real until) {
    std::ifstream in(file, std::ios::binary);
    if (!in) return {};
    std::stringstream all;
    all << in.rdbuf();
    const std::string text = all.str();
    if (text.empty()) return {};
    if (!text.starts_with(head))
        refuse_in(file.string(), "output", "first line",
                  "\"" + text.substr(0, std::min<std::size_t>(text.find('\n'), 60)) + "\"",
                  "the column headings of the recorded probes",
                  "a continued run appends its rows to the file; choose another file or delete this one");
    std::string rows;
    for (std::size_t begin = head.size(), end; (end = text.find('\n', begin)) != std::string::npos; begin = end + 1) {
        const std::string line = text.substr(begin, end + 1 - begin);
        char* number_end = nullptr;
        const Real time = std::strtod(line.c_str(), &number_end);
        if (number_end == line.c_str() || !(time <= until * (1 + slack))) break;
        rows += line;
    }
    return rows;
}

}  // namespace

std::string SeriesColumn::heading() const {
    return (probe.empty() ? quantity : probe + "." + quantity) + " [" + unit + "]";
}

PointProbe probe_point(const World& world, BodyHandle body, const Vec3& point) {
    const std::span<const Vec3> nodes = world.positions(body);
    const auto found = follow_point(nodes, world.tetrahedra(body), point, world.mean_edge(body));
    if (!found) {
        const auto [node, distance] = nearest_node(nodes, point);
        std::string nearest = "a point of the body";
        if (node != no_index)
            nearest += "; the nearest node is " + std::to_string(node) + ", " + short_text(distance, 6) +
                       " m away, at " + short_text(nodes[node], 6) + " m";
        refuse("body '" + world.name(body) + "'", "point", short_text(point, 6) + " m", nearest);
    }
    return {.body = body, .node = found->node, .weight = found->weight};
}

struct Recorder::Impl {
    std::vector<TrackedProbe> probes;
    std::vector<SeriesColumn> columns;
    Real every = 0, next = 0;  // time between rows, and time at which the next row is due [s]
    bool begun = false;
    Real last_time = 0;        // simulated time at the last call of sample() [s]
    std::vector<Real> values;  // recorded values of all rows, one row after the other
    std::filesystem::path stream_file;
    std::ofstream stream;
    std::uintmax_t stream_size = 0;  // size of the file up to the last complete row [bytes]

    std::size_t rows() const { return values.size() / columns.size(); }
    std::span<const Real> row(std::size_t number) const {
        return std::span<const Real>(values).subspan(number * columns.size(), columns.size());
    }
    void append_row_text(const std::string& text) {
        errno = 0;
        stream << text << std::flush;
        stream_size += text.size();
        if (stream) return;
        const std::string reason = std::generic_category().message(errno);
        stream.close();
        // The file is truncated to its last complete row.
        std::error_code ignored;
        std::filesystem::resize_file(stream_file, stream_size - text.size(), ignored);
        refuse_in(stream_file.string(), "output", {}, "the error \"" + reason + "\" while writing a row",
                  "enough space for the row", "free disk space, then continue or repeat the run");
    }
};

Recorder::Recorder(World& world, std::vector<RecordedProbe> probes, Real every) : impl_(std::make_unique<Impl>()) {
    if (!(every >= 0) || !std::isfinite(every)) refuse("Recorder", "every", std::to_string(every), "a time >= 0 (s)");
    check_probes(world, probes);
    impl_->every = every;
    impl_->last_time = world.time();
    if (every > 0) impl_->next = (std::floor(world.time() / every + slack) + 1) * every;
    impl_->columns.push_back({"", "time", "s"});
    for (const RecordedProbe& probe : probes) add_columns(world, probe, impl_->columns);
    impl_->probes = track(world, std::move(probes));
}
Recorder::~Recorder() = default;
Recorder::Recorder(Recorder&&) noexcept = default;
Recorder& Recorder::operator=(Recorder&&) noexcept = default;

void Recorder::sample(const World& world) {
    Impl& r = *impl_;
    const Real time = world.time();
    // If no step was made since the last call of sample(), there are no forces to add and no new row.
    if (r.begun && !(time > r.last_time)) return;
    if (time > r.last_time)
        for (TrackedProbe& probe : r.probes) add_forces(world, probe);
    const bool initial = !r.begun && !(time > r.last_time);
    r.last_time = time;
    if (!initial && time < r.next - slack * r.every) return;
    r.begun = true;
    if (r.every > 0) r.next = (std::floor(time / r.every + slack) + 1) * r.every;
    const std::size_t before = r.values.size();
    try {
        r.values.push_back(time);
        for (TrackedProbe& probe : r.probes) put_row(world, probe, r.values);
    } catch (...) {
        r.values.resize(before);  // removes the values of a row that could not be completed
        throw;
    }
    if (r.stream.is_open()) r.append_row_text(csv_row(r.row(r.rows() - 1)));
}

const std::vector<SeriesColumn>& Recorder::columns() const {
    return impl_->columns;
}
std::size_t Recorder::row_count() const {
    return impl_->rows();
}
std::span<const Real> Recorder::row(std::size_t number) const {
    return impl_->row(number);
}

void Recorder::stream_csv(const std::filesystem::path& file, std::optional<Real> keep_until) {
    Impl& r = *impl_;
    const std::string head = csv_head(r.columns);
    const std::string kept_rows = keep_until ? rows_to_keep(file, head, *keep_until) : std::string();
    write_file(file, [&](std::ostream& out) {
        out << head << kept_rows;
        for (std::size_t i = 0; i < r.rows(); ++i) out << csv_row(r.row(i));
    });
    r.stream_file = file;
    errno = 0;
    r.stream = std::ofstream(file, std::ios::binary | std::ios::app);
    std::error_code ignored;  // the size of a pipe is unknown, so file_size fails
    r.stream_size = std::filesystem::file_size(file, ignored);
    if (!r.stream) r.append_row_text("");
}

void Recorder::write_csv(const std::filesystem::path& file) const {
    write_file(file, [&](std::ostream& out) {
        out << csv_head(impl_->columns);
        for (std::size_t i = 0; i < impl_->rows(); ++i) out << csv_row(impl_->row(i));
    });
}

}  // namespace skerry
