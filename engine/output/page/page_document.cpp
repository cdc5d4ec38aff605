#include "engine/output/page/page_document.h"

#include <cstdio>
#include <fstream>
#include <iterator>
#include <ostream>
#include <span>
#include <sstream>
#include <utility>

#include "engine/base/complaint.h"
#include "engine/base/write_file.h"
#include "engine/output/escape_markup.h"
#include "engine/output/page/page_assets.h"
#include "engine/output/page/stream/pack.h"

namespace skerry {
namespace {

Json json_of(const Vec3& v) {
    return {v.x(), v.y(), v.z()};
}

/// Encodes rows of numbers of type T as base64. The page decodes them to a typed array.
template <class T, class Rows>
std::string packed(const Rows& rows) {
    std::string bytes;
    for (const auto& row : rows)
        for (const auto value : row) put(bytes, static_cast<T>(value));
    return base64(bytes);
}

Json json_of_colliders(std::span<const PageCollider> colliders) {
    Json list = Json::array();
    for (const PageCollider& collider : colliders)
        list.push_back(object_of({{"name", collider.name},
                                  {"kind", collider.kind},
                                  {"points", packed<float>(collider.picture.nodes)},
                                  {"triangles", packed<std::uint32_t>(collider.picture.triangles)}}));
    return list;
}

/// Returns an image as a data URI, or an empty text if the file is no PNG or JPEG image, too large, or not readable.
std::string image_uri(const std::filesystem::path& file) {
    constexpr std::uintmax_t most_bytes = 2 << 20;  // limit so that images do not dominate the size of a page [bytes]
    const std::string extension = file.extension().string();
    const bool is_png = extension == ".png" || extension == ".PNG";
    if (!is_png && extension != ".jpg" && extension != ".jpeg" && extension != ".JPG") return {};
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error) || std::filesystem::file_size(file, error) > most_bytes)
        return {};
    std::ifstream in(file, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    return std::string("data:image/") + (is_png ? "png" : "jpeg") + ";base64," + base64(bytes);
}

/// Materials of each visual surface. A texture that image_uri() cannot encode is missing on the page, and "left_out"
/// gives the name of its file.
Json json_of_visuals(std::span<const std::vector<VisualMaterial>> visuals) {
    Json list = Json::array();
    for (const std::vector<VisualMaterial>& materials : visuals) {
        Json& rows = list.emplace_back(Json::array());
        for (const VisualMaterial& material : materials) {
            const std::string image = material.texture.empty() ? "" : image_uri(material.texture);
            rows.push_back(object_of({{"name", material.name},
                                      {"color", material.color},
                                      {"opacity", material.opacity},
                                      {"image", image},
                                      {"left_out", image.empty() ? material.texture : ""}}));
        }
    }
    return list;
}

Json json_of_lines(std::span<const PageLine> lines) {
    Json list = Json::array();
    for (const PageLine& line : lines) list.push_back(object_of({{"name", line.name}, {"kind", name_of(line.kind)}}));
    return list;
}

/// Plotted quantities as JSON: one array per quantity, with one value per frame.
Json json_of_rows(const PageData& data) {
    Json rows = json_of_row({});
    for (Json& column : rows) column = Json::array();
    for (const PageRow& row : data.rows()) {
        const Json values = json_of_row(row);
        for (const auto& [name, value] : values.items()) rows[name].push_back(value);
    }
    return rows;
}

Json json_of_report(const PageSummary& summary) {
    const WorldReport& report = summary.report;
    Json stages = Json::array();
    for (const StageReport& stage : report.stages)
        stages.push_back(object_of(
            {{"name", stage.name}, {"seconds", stage.seconds}, {"runs", stage.runs}, {"skipped", stage.skipped}}));
    Json self_crossings = Json::array();
    for (const SelfCrossing& crossing : report.self_crossings) self_crossings.push_back(crossing.message());
    char hash[17];
    std::snprintf(hash, sizeof hash, "%016llx", static_cast<unsigned long long>(summary.state_hash));
    return object_of({{"time", report.time},
                      {"steps", report.steps},
                      {"bodies", report.bodies},
                      {"colliders", report.colliders},
                      {"nodes", report.nodes},
                      {"elements", report.elements},
                      {"stable_step", report.stable_step},
                      {"mean_contacts", report.mean_contacts},
                      {"max_contacts", report.max_contacts},
                      {"mean_regions", report.mean_regions},
                      {"max_regions", report.max_regions},
                      {"largest_region", report.largest_region},
                      {"mean_iterations", report.mean_iterations},
                      {"solved", report.solved},
                      {"closed_form", report.closed_form},
                      {"certified", report.certified},
                      {"unconverged", report.unconverged},
                      {"worst_error", report.worst_error},
                      {"max_penetration", report.max_penetration},
                      {"self_crossings", self_crossings},
                      {"distrust", report.distrust()},
                      {"state_hash", hash},
                      {"stages", stages}});
}

/// Two possible upper ends of the legend of a field: the largest value, and the value below which 99 % of the values
/// lie.
Json json_of(const Quantile& quantile) {
    return object_of({{"max", quantile.max()}, {"usual", quantile.at(0.99)}});
}

Json json_of_data(const PageData& data, const PageSummary& summary) {
    Json json = object_of({{"title", summary.title}, {"gravity", json_of(data.gravity())}});
    json.update(json_of_objects(data.stream(), {}));
    json.update(object_of({{"rows", json_of_rows(data)},
                           {"speed", json_of(data.fields()[0])},
                           {"stress", json_of(data.fields()[stress_field])},
                           {"strain", json_of(data.fields()[strain_field])},
                           {"error", json_of(data.fields()[error_field])},
                           {"force", json_of(data.force())},
                           {"line_force", json_of(data.line_force())},
                           {"report", json_of_report(summary)}}));
    return json;
}

/// Returns JSON as the text of a script element. Every '<' is escaped, so that no name can close the element.
std::string script_text(const Json& json) {
    std::string text;
    for (const char c : text_of(json)) {
        if (c == '<')
            text += "\\u003c";
        else
            text += c;
    }
    return text;
}

std::string escape_html(const std::string& text) {
    // The text is converted to JSON and back, because this conversion replaces bytes that are not UTF-8.
    return escape_markup(Json::parse(text_of(text)).get<std::string>());
}

/// Parts of a page that differ from page to page.
struct PageParts {
    std::string title, run, frames, visuals;
};

void put_page(std::ostream& out, const PageParts& parts) {
    // Replaces the @marks@ of the template in one pass, so that marks inside an inserted text stay unchanged.
    std::string_view rest = page_html;
    const auto replace = [&](std::string_view mark, std::string_view text) {
        const std::size_t position = rest.find(mark);
        out << rest.substr(0, position) << text;
        rest.remove_prefix(position + mark.size());
    };
    replace("@title@", escape_html(parts.title));
    replace("@style@", page_style);
    replace("@run@", parts.run);
    replace("@frames@", parts.frames);
    replace("@visuals@", parts.visuals);
    replace("@three@", base64(three_js));
    replace("@script@", page_script);
    out << rest;
}

}  // namespace

void require_page_library(const std::filesystem::path& file) {
    if (!three_js.empty()) return;
    refuse_in(file.string(), "page", {}, "a build without three.js", "a build with three.js",
              "install the package libjs-three, or set the CMake variable SKERRY_THREE_JS to the file "
              "three.min.js, then build again");
}

PageCounts counts_of(const PageStream& stream) {
    return {.bodies = stream.bodies().size(),
            .visuals = stream.visuals().materials().size(),
            .colliders = stream.colliders().size(),
            .lines = stream.lines().size()};
}

Json json_of_objects(const PageStream& stream, const PageCounts& first) {
    return object_of({{"bodies", stream.body_names().subspan(first.bodies)},
                      {"visual_of_body", stream.visual_numbers().subspan(first.bodies)},
                      {"visuals", json_of_visuals(std::span(stream.visuals().materials()).subspan(first.visuals))},
                      {"colliders", json_of_colliders(stream.colliders().subspan(first.colliders))},
                      {"lines", json_of_lines(stream.lines().subspan(first.lines))}});
}

Json json_of_row(const PageRow& row) {
    return object_of({{"time", row.time},
                      {"kinetic", row.energy.kinetic},
                      {"elastic", row.energy.elastic},
                      {"potential", row.energy.potential},
                      {"dissipated", row.energy.dissipated},
                      {"contacts", row.contacts},
                      {"stick", row.stick},
                      {"slide", row.slide},
                      {"regions", row.regions}});
}

std::string text_of(const Json& json) {
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

void write_page(const std::filesystem::path& file, const PageData& data, const PageSummary& summary) {
    require_page_library(file);
    write_file(file, [&](std::ostream& out) {
        put_page(out, {.title = summary.title,
                       .run = script_text(json_of_data(data, summary)),
                       .frames = base64(data.packed_frames()),
                       .visuals = base64(data.stream().visuals().packed())});
    });
}

std::string live_page() {
    require_page_library({});
    std::ostringstream out;
    put_page(out, {.title = "Skerry", .run = "{\"live\":true}", .frames = {}, .visuals = {}});
    return std::move(out).str();
}

}  // namespace skerry
