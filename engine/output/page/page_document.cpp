#include "engine/output/page/page_document.h"

#include <cstdio>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <ostream>

#include "engine/output/escape_markup.h"
#include "engine/output/page/page_assets.h"
#include "engine/output/page/stream/deflate.h"
#include "engine/output/page/stream/pack.h"
#include "engine/output/write_file.h"
#include "skerry/error.h"

namespace skerry {
namespace {

using Json = nlohmann::ordered_json;

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

Json json_of_colliders(const PageData& data) {
    Json list = Json::array();
    for (const PageCollider& collider : data.colliders())
        list.push_back({{"name", collider.name},
                        {"kind", collider.kind},
                        {"points", packed<float>(collider.picture.nodes)},
                        {"triangles", packed<std::uint32_t>(collider.picture.triangles)}});
    return list;
}

/// Returns an image as a data URI, or an empty text if the file is no PNG or JPEG image, too large, or not readable.
std::string image_uri(const std::filesystem::path& file) {
    constexpr std::uintmax_t most_bytes = 2 << 20;  // most of a page without textures is smaller
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

/// Materials of each visual surface. A texture that is not part of the page is only named.
Json json_of_visuals(const PageData& data) {
    Json list = Json::array();
    for (const std::vector<VisualMaterial>& materials : data.visuals().materials()) {
        Json& rows = list.emplace_back(Json::array());
        for (const VisualMaterial& material : materials) {
            const std::string image = material.texture.empty() ? "" : image_uri(material.texture);
            rows.push_back({{"name", material.name},
                            {"color", material.color},
                            {"opacity", material.opacity},
                            {"image", image},
                            {"left_out", image.empty() ? material.texture : ""}});
        }
    }
    return list;
}

Json json_of_lines(const PageData& data) {
    Json list = Json::array();
    for (const PageLine& line : data.lines().lines())
        list.push_back({{"name", line.name}, {"kind", name_of(line.kind)}});
    return list;
}

/// Plotted quantities as JSON: one array per quantity, with one value per frame.
Json json_of_rows(const PageData& data) {
    Json rows;
    const auto column = [&](const char* name, auto&& value) {
        Json& list = rows[name] = Json::array();
        for (const PageRow& row : data.rows()) list.push_back(value(row));
    };
    column("time", [](const PageRow& row) { return row.time; });
    column("kinetic", [](const PageRow& row) { return row.energy.kinetic; });
    column("elastic", [](const PageRow& row) { return row.energy.elastic; });
    column("potential", [](const PageRow& row) { return row.energy.potential; });
    column("dissipated", [](const PageRow& row) { return row.energy.dissipated; });
    column("contacts", [](const PageRow& row) { return row.contacts; });
    column("stick", [](const PageRow& row) { return row.stick; });
    column("slide", [](const PageRow& row) { return row.slide; });
    column("regions", [](const PageRow& row) { return row.regions; });
    return rows;
}

Json json_of_report(const PageSummary& summary) {
    const WorldReport& report = summary.report;
    Json stages = Json::array();
    for (const StageReport& stage : report.stages)
        stages.push_back(
            {{"name", stage.name}, {"seconds", stage.seconds}, {"runs", stage.runs}, {"skipped", stage.skipped}});
    Json self_crossings = Json::array();
    for (const SelfCrossing& crossing : report.self_crossings) self_crossings.push_back(crossing.message());
    char hash[17];
    std::snprintf(hash, sizeof hash, "%016llx", static_cast<unsigned long long>(summary.state_hash));
    return {{"time", report.time},
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
            {"stages", stages}};
}

/// Two possible upper ends of the legend of a field: the largest value, and the value below which 99 % of the values
/// lie.
Json json_of(const Quantile& quantile) {
    return {{"max", quantile.max()}, {"usual", quantile.at(0.99)}};
}

std::string describe(const PageData& data, const PageSummary& summary) {
    const Json json = {{"schema", 3},
                       {"title", summary.title},
                       {"gravity", json_of(data.gravity())},
                       {"bodies", data.body_names()},
                       {"visual_of_body", data.visual_numbers()},
                       {"visuals", json_of_visuals(data)},
                       {"colliders", json_of_colliders(data)},
                       {"rows", json_of_rows(data)},
                       {"speed", json_of(data.fields()[0])},
                       {"stress", json_of(data.fields()[1])},
                       {"strain", json_of(data.fields()[2])},
                       {"force", json_of(data.force())},
                       {"lines", json_of_lines(data)},
                       {"line_force", json_of(data.lines().force())},
                       {"report", json_of_report(summary)}};
    // Names come from users and may contain any bytes. Bytes that are not UTF-8 become U+FFFD. Every '<' is escaped, so
    // that no name can close the script element.
    std::string text;
    for (const char c : json.dump(-1, ' ', false, Json::error_handler_t::replace)) {
        if (c == '<')
            text += "\\u003c";
        else
            text += c;
    }
    return text;
}

std::string escape_html(const std::string& text) {
    // The text is converted to JSON and back, because this conversion replaces bytes that are not UTF-8.
    std::string clean = Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
    clean = Json::parse(clean).get<std::string>();
    return escape_markup(clean);
}

/// Returns three.js in compressed form, which has about a fifth of the size of its text.
std::string packed_three_js() {
    Deflater deflater;
    deflater.add(three_js);
    return deflater.packed();
}

}  // namespace

void require_page_library(const std::filesystem::path& file) {
    if (!three_js.empty()) return;
    Complaint{.file = file.string(),
              .object = "page",
              .field = {},
              .found = "a build without three.js",
              .expected = "a build with three.js",
              .hint =
                  "install the package libjs-three, or set the CMake variable SKERRY_THREE_JS to the file "
                  "three.min.js, then build again"}
        .raise();
}

void write_page(const std::filesystem::path& file, const PageData& data, const PageSummary& summary) {
    require_page_library(file);
    write_file(file, [&](std::ostream& out) {
        // Replaces the @marks@ of the template in one pass, so that marks inside an inserted text stay unchanged.
        std::string_view rest = page_html;
        const auto upto = [&](std::string_view mark) {
            const std::size_t place = rest.find(mark);
            out << rest.substr(0, place);
            rest.remove_prefix(place + mark.size());
        };
        upto("@title@");
        out << escape_html(summary.title);
        upto("@style@");
        out << page_style;
        upto("@run@");
        out << describe(data, summary);
        upto("@frames@");
        out << base64(data.packed_frames());
        upto("@visuals@");
        out << base64(data.visuals().packed());
        upto("@three@");
        out << base64(packed_three_js());
        upto("@script@");
        out << page_script << rest;
    });
}

}  // namespace skerry
