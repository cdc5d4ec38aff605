// Writes the synthetic run as files with their expected contents, for tests that read them with other programs:
//   output_sample_files FOLDER
#include <cmath>
#include <filesystem>
#include <fstream>
#include <utility>

#include "engine/mesh/visual/bound_visual.h"
#include "engine/output/json_object.h"
#include "engine/output/page/stream/pack.h"
#include "engine/output/vtk/vtk_series.h"
#include "output_sample.h"

namespace {

using namespace skerry;

Json json_of(const Vec3& v) {
    return {v.x(), v.y(), v.z()};
}

Json json_of_matrix(const Mat3& m) {
    return {json_of(Vec3(m.row(0))), json_of(Vec3(m.row(1))), json_of(Vec3(m.row(2)))};
}

Json expected(const Frame& frame) {
    Json json = {{"time", frame.time},        {"points", 0},
                 {"position", Json::array()}, {"velocity", Json::array()},
                 {"cells", Json::array()},    {"stress", Json::array()},
                 {"strain", Json::array()},   {"node_stress", Json::array()},
                 {"body", Json::array()}};
    Index first = 0;
    for (const BodyFrame& body : frame.bodies) {
        for (const Vec3& p : body.position) json["position"].push_back(json_of(p));
        for (const Vec3& v : body.velocity) json["velocity"].push_back(json_of(v));
        for (const auto& [a, b, c, d] : body.tetrahedra)
            json["cells"].push_back({first + a, first + b, first + c, first + d});
        for (const Mat3& stress : body.stress) {
            json["stress"].push_back(json_of_matrix(stress));
            json["body"].push_back(body.handle.slot);
        }
        for (const Mat3& strain : body.strain) json["strain"].push_back(json_of_matrix(strain));
        for (const Mat3& strain : body.node_strain) json["node_strain"].push_back(json_of_matrix(strain));
        for (const Index material : body.material) json["material"].push_back(material);
        for (const Mat3& stress : body.node_stress) json["node_stress"].push_back(json_of_matrix(stress));
        first += static_cast<Index>(body.position.size());
    }
    Json& contacts = json["contacts"] = Json::array();
    for (const Contact& c : frame.contacts)
        contacts.push_back({{"point", json_of(c.point)},
                            {"normal", json_of(c.normal)},
                            {"impulse", json_of(c.impulse)},
                            {"force", json_of(c.impulse * 1200)},
                            {"slip", json_of(c.slip)},
                            {"distance", c.distance},
                            {"gap", c.gap},
                            {"state", static_cast<int>(c.motion)},
                            {"region", c.region},
                            {"first_body", c.first.slot}});
    Json& lines = json["lines"] = Json::array();
    for (const LineFrame& line : frame.lines) {
        lines.push_back({{"kind", static_cast<int>(line.kind)}, {"joined", line.is_joined()}, {"force", line.force}});
        for (const Vec3& point : line.points) lines.back()["points"].push_back(json_of(point));
    }
    return json;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) return 2;
    const std::filesystem::path folder = argv[1];
    std::filesystem::remove_all(folder);

    // Few nodes, because the contents are compared number by number. The first ball is number 0 although it is removed;
    // the second is added late.
    OutputSample small(3, 1, 45);
    VtkSeries series(folder / "vtk", "drop & bounce");
    series.name_materials({"gum <& \"rubber\">"});
    Json frames = Json::array();
    std::map<std::uint32_t, int> number;
    std::map<int, std::string> names;
    std::map<std::uint32_t, std::vector<Vec3>> origin;
    for (int i = 0; i < small.frame_count(); ++i) {
        const Frame& frame = small.frame(i);
        series.write_frame(frame);
        for (const BodyFrame& body : frame.bodies)
            number.try_emplace(body.handle.slot, static_cast<int>(number.size()));
        Json json = expected(frame);
        for (const BodyFrame& body : frame.bodies) {
            const std::vector<Vec3>& first =
                origin.try_emplace(body.handle.slot, body.position.begin(), body.position.end()).first->second;
            for (std::size_t n = 0; n < first.size(); ++n)
                json["displacement"].push_back(json_of(body.position[n] - first[n]));
            names[number.at(body.handle.slot)] = body.name;
        }
        for (const auto& [of, name] : names)
            json["body_names"].push_back(std::vector<unsigned char>(name.begin(), name.end()));
        for (Json& slot : json["body"]) slot = number.at(slot.get<std::uint32_t>());
        for (Json& contact : json["contacts"])
            contact["first_body"] = number.at(contact["first_body"].get<std::uint32_t>());
        frames.push_back(json);
    }
    series.write_index();
    std::ofstream(folder / "vtk" / "expected.json") << Json{{"name", "drop & bounce"}, {"frames", frames}};

    // Size for which a page may take 10 MB: 120 frames of 5,136 vertices.
    OutputSample large(8, 3, 120);
    PageData data;
    for (int i = 0; i < large.frame_count(); ++i) data.add(large.frame(i));
    write_page(folder / "page.html", data, large.summary());
    // Balls that are drawn as red copies of them, 1.2 times as large.
    OutputSample drawn(3, 2, 3);
    PageData with_visual;
    BoundVisual visual;
    for (int i = 0; i < drawn.frame_count(); ++i) {
        Frame frame = drawn.frame(i);
        if (i == 0) {
            const BodyFrame& ball = frame.bodies.front();
            VisualSurface surface{.nodes = {ball.position.begin(), ball.position.end()},
                                  .triangles = {ball.surface.begin(), ball.surface.end()},
                                  .materials = {{.name = "red", .color = {1, 0, 0}}},
                                  .material = std::vector<Index>(ball.surface.size(), 0)};
            for (Vec3& node : surface.nodes) node += 0.2 * (node - ball.position[0]);
            visual = bind_visual(std::move(surface), ball.position, ball.tetrahedra);
        }
        for (BodyFrame& ball : frame.bodies) ball.visual = &visual;
        with_visual.add(frame);
    }
    write_page(folder / "visual.html", with_visual, drawn.summary());
    write_page(folder / "empty.html", PageData{}, {.title = "Nothing", .report = {}, .state_hash = 0});

    // A live page, and by frame the new objects and the bytes that a server sends to it. Expected values: position of
    // node 1 of the first body, sums of the points and forces of all contacts.
    std::ofstream(folder / "live.html") << live_page();
    OutputSample live(3, 2, 60);
    PageStream stream;
    PageCounts known;
    Json sent = Json::array();
    for (int i = 0; i < live.frame_count(); ++i) {
        const Frame& frame = live.frame(i);
        const std::string bytes(stream.pack(frame));
        Vec3 points = Vec3::Zero(), forces = Vec3::Zero();
        for (const Contact& contact : frame.contacts) {
            points += contact.point;
            forces += contact.force();
        }
        Json objects = Json::parse(text_of(json_of_objects(stream, known)));
        sent.push_back({{"objects", std::move(objects)},
                        {"bytes", base64(bytes)},
                        {"node", json_of(frame.bodies.front().position[1])},
                        {"points", json_of(points)},
                        {"forces", json_of(forces)}});
        known = counts_of(stream);
    }
    std::ofstream(folder / "live.json") << sent;
}
