#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>

#include "engine/output/page/page_document.h"
#include "engine/output/page/stream/pack.h"
#include "output_sample.h"
#include "page_stream_reader.h"
#include "skerry/error.h"
#include "systems/dynamics/elements/element_energy.h"
#include "tests/support/temporary_folder.h"

namespace skerry::test::output_page_test {

namespace {

constexpr Real not_a_number = std::numeric_limits<Real>::quiet_NaN(), infinity = std::numeric_limits<Real>::infinity();

std::string page_of(const PageData& data, const PageSummary& summary) {
    const TemporaryFolder folder;
    const std::filesystem::path file = folder.path() / "page.html";
    write_page(file, data, summary);
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

/// Text of the script element with this id.
std::string text_of(const std::string& page, const std::string& id) {
    const std::string opening = "id=\"" + id + "\">";
    const std::size_t begin = page.find(opening) + opening.size();
    return page.substr(begin, page.find("</script>", begin) - begin);
}

nlohmann::json run_of(const std::string& page) {
    return nlohmann::json::parse(text_of(page, "run"));
}

/// Half the width of a code at `value`, on a square-root scale that ends at `top`.
Real half_code(Real value, Real top) {
    return std::sqrt(std::abs(value) * top) / 2047 + top / (4 * 2047.0 * 2047);
}

std::size_t count_of(const std::string& text, const std::string& part) {
    std::size_t count = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++count;
    return count;
}

}  // namespace

TEST_CASE("base64 gives the test vectors of RFC 4648", "[unit][output]") {
    CHECK(base64("") == "");
    CHECK(base64("f") == "Zg==");
    CHECK(base64("fo") == "Zm8=");
    CHECK(base64("foo") == "Zm9v");
    CHECK(base64("foobar") == "Zm9vYmFy");
    CHECK(base64("\xff\xfe\xfd") == "//79");
}

TEST_CASE("counts and changes take a byte where they are small", "[unit][output]") {
    std::string bytes;
    put_count(bytes, 127);
    put_count(bytes, 128);
    put_change(bytes, -1);
    put_change(bytes, 64);
    CHECK(bytes == std::string("\x7f\x80\x01\x01\x80\x01", 6));
    CHECK(zigzag(0) == 0);
    CHECK(zigzag(-3) == 5);
    CHECK(zigzag(std::numeric_limits<std::int64_t>::min()) == ~std::uint64_t{0});
}

TEST_CASE("a value comes back within half a code, whatever its size and sign", "[unit][output]") {
    ValueScale scale;
    for (const Real widest : {1e-3, 1.0, 70.0, 1e9}) {
        scale.widen(widest);
        CHECK(scale.top() >= widest);
        CHECK(scale.top() < 4 * widest);
        for (Real value = widest; value > 1e-9 * widest; value /= 3)
            for (const Real signed_value : {value, -value})
                CHECK(std::abs(scale.value(scale.code(signed_value)) - signed_value) <=
                      1.000001 * half_code(value, scale.top()));
    }
    CHECK(scale.code(0) == 0);
    CHECK(scale.code(not_a_number) == 0);
    CHECK(scale.code(infinity) == ValueScale::last);
    scale.widen(infinity);
    scale.widen(not_a_number);
    CHECK(scale.top() < 4e9);
    scale.widen(std::numeric_limits<Real>::max());
    CHECK(std::isfinite(scale.top()));
}

TEST_CASE("a wider scale halves codes by each factor of four", "[unit][output]") {
    ValueScale scale;
    scale.widen(1);
    const int exponent = scale.exponent(), code = scale.code(0.25);
    scale.widen(16);
    CHECK(scale.exponent() == exponent + 2);
    CHECK(std::abs(shifted(code, exponent, scale.exponent()) - scale.code(0.25)) <= 1);
    CHECK(shifted(code, -255, 511) == 0);
}

TEST_CASE("points on a lattice are right to half a step, and points that are not finite stay", "[unit][output]") {
    const std::vector<Vec3> points{{-1, 5, 3}, {2, 5, not_a_number}, {0.123, 5, -4}, {infinity, 0, 0}};
    const Lattice lattice = Lattice::around(points);
    CHECK(lattice.origin == Vec3(-1, 5, -4));
    CHECK(lattice.step == 7.0 / Lattice::steps);
    for (const Vec3& point : {Vec3(0.5, 5.001, -3.99), Vec3(-1e6, 1e7, 3e5)})
        CHECK((lattice.point(lattice.code(point, {})) - point).cwiseAbs().maxCoeff() <= lattice.step / 2 * 1.000001);
    CHECK(lattice.code({not_a_number, infinity, 1e300}, {7, 8, 9}) == Code3{7, 8, 9});
    CHECK(Lattice::around(std::vector<Vec3>{{1, 1, 1}}).step > 0);
}

TEST_CASE("a stream comes back whole at any time, and goes on", "[unit][output]") {
    Deflater deflater;
    std::string all;
    CHECK(inflate_all(deflater.packed()).empty());
    for (int i = 0; i < 40; ++i) {
        std::string part;
        for (int k = 0; k < 5000; ++k) skerry::put(part, static_cast<std::uint32_t>(k * k * i) * 2654435761u);
        deflater.add(part);
        all += part;
        if (i % 13 == 0) CHECK(inflate_all(deflater.packed()) == all);
    }
    CHECK(inflate_all(deflater.packed()) == all);
}

TEST_CASE("a quantile is right to its two percent and ignores what a legend cannot show", "[unit][output]") {
    Quantile quantile;
    CHECK(quantile.at(0.99) == 0);
    for (const Real odd : {0.0, -1.0, not_a_number, infinity}) quantile.add(odd);
    CHECK(quantile.max() == 0);
    for (int i = 1; i <= 1000; ++i) quantile.add(i);
    quantile.add(1e9);
    CHECK(quantile.at(0.99) == Approx(991).epsilon(0.021));
    CHECK(quantile.at(0.5) == Approx(501).epsilon(0.021));
    CHECK(quantile.at(1) == 1e9);
}

TEST_CASE("packed frames give back places to half a step and values to half a code", "[unit][output]") {
    OutputSample sample(3, 1, 30);
    PageData data;
    for (int i = 0; i < 30; ++i) data.add(sample.frame(i));
    const ReadRun run = read_run(data.packed_frames());
    REQUIRE(run.frames.size() == 30);
    REQUIRE(run.shapes.size() == 3);
    for (int i = 0; i < 30; ++i) {
        const Frame& frame = sample.frame(i);
        const ReadFrame& read = run.frames[static_cast<std::size_t>(i)];
        REQUIRE(read.bodies.size() == frame.bodies.size());
        CHECK(read.colliders == std::vector<std::size_t>{0, 1, 2, 3, 4});
        for (std::size_t b = 0; b < frame.bodies.size(); ++b) {
            const BodyFrame& body = frame.bodies[b];
            const ReadShape& shape = run.shapes[read.bodies[b].number];
            REQUIRE(shape.node.size() == body.position.size() - 1);  // all nodes except the inner one
            REQUIRE(shape.triangles.size() == body.surface.size());
            CHECK(shape.step < 0.3 / Lattice::steps);  // balls are 0.2 m wide plus a wobble
            Real farthest = 0;
            std::array<Real, read_field_count> worst{};  // largest errors in units of half_code()
            for (std::size_t vertex = 0; vertex < shape.node.size(); ++vertex) {
                const auto node = static_cast<std::size_t>(shape.node[vertex]);
                farthest =
                    std::max(farthest, (read.bodies[b].position[vertex] - body.position[node]).cwiseAbs().maxCoeff());
                const std::array value{body.velocity[node].norm(), von_mises(body.node_stress[node]),
                                       von_mises(body.node_strain[node]) * 2 / 3, body.node_mesh_error[node]};
                for (std::size_t f = 0; f < value.size(); ++f)
                    worst[f] = std::max(worst[f], std::abs(read.bodies[b].value[f][vertex] - value[f]) /
                                                      half_code(value[f], read.top[f]));
            }
            CHECK(farthest <= shape.step / 2 * 1.000001);
            for (const Real halves : worst) CHECK(halves <= 1.001);  // a code is exact to a half; the root rounds
            for (std::size_t t = 0; t < body.surface.size(); ++t)
                for (std::size_t k = 0; k < 3; ++k)
                    CHECK(shape.node[static_cast<std::size_t>(shape.triangles[t][k])] == body.surface[t][k]);
        }
    }
}

TEST_CASE("packed contacts give back bodies, places, strengths and earlier rows", "[unit][output]") {
    OutputSample sample(3, 2, 60);
    PageData data;
    for (int i = 0; i < 60; ++i) data.add(sample.frame(i));
    const ReadRun run = read_run(data.packed_frames());
    std::size_t seen = 0, found_again = 0;
    std::vector<Contact> last;
    for (int i = 0; i < 60; ++i) {
        const Frame& frame = sample.frame(i);
        const ReadFrame& read = run.frames[static_cast<std::size_t>(i)];
        REQUIRE(read.contacts.size() == frame.contacts.size());
        for (std::size_t c = 0; c < frame.contacts.size(); ++c) {
            const Contact& contact = frame.contacts[c];
            const ReadContact& row = read.contacts[c];
            ++seen;
            REQUIRE(row.first >= 0);
            CHECK(row.second == -1);
            CHECK(row.collider == 0);
            CHECK((row.point - contact.point).cwiseAbs().maxCoeff() <=
                  run.shapes[static_cast<std::size_t>(row.first)].step / 2 * 1.000001);
            const Vec3 force = contact.force();
            for (Index axis = 0; axis < 3; ++axis)
                CHECK(std::abs(row.force[axis] - force[axis]) <= 1.001 * half_code(force[axis], read.top.back()));
            CHECK(std::abs(row.normal_force - force.z()) <= 1.001 * half_code(force.z(), read.top.back()));
            CHECK(row.state == static_cast<int>(contact.motion));
            CHECK(row.region == contact.region);
            if (row.row_prev >= 0) {
                ++found_again;
                const Contact& prev = last.at(static_cast<std::size_t>(row.row_prev));
                CHECK(prev.first == contact.first);
                CHECK(prev.node == contact.node);
            }
        }
        last.assign(frame.contacts.begin(), frame.contacts.end());
    }
    CHECK(seen > 100);
    CHECK(found_again > seen / 2);
}

TEST_CASE("packed lines give back points to half a step and forces to half a code, whatever comes and goes",
          "[unit][output]") {
    OutputSample sample(3, 1, 40);
    PageData data;
    data.add(Frame{});
    for (int i = 0; i < 40; ++i) data.add(sample.frame(i));
    const ReadRun run = read_run(data.packed_frames());
    CHECK(run.step_of_lines < 1.0 / Lattice::steps);
    CHECK(run.frames[0].lines.empty());
    for (int i = 0; i < 40; ++i) {
        const Frame& frame = sample.frame(i);
        const ReadFrame& read = run.frames[static_cast<std::size_t>(i + 1)];
        REQUIRE(read.lines.size() == frame.lines.size());
        for (std::size_t l = 0; l < frame.lines.size(); ++l) {
            const LineFrame& line = frame.lines[l];
            const PageLine& page_line = data.stream().lines()[read.lines[l].number];
            CHECK(page_line.name == line.name);
            CHECK(page_line.kind == line.kind);
            REQUIRE(read.lines[l].points.size() == line.points.size());
            for (std::size_t p = 0; p < line.points.size(); ++p) {
                const Real off = (read.lines[l].points[p] - line.points[p]).cwiseAbs().maxCoeff();
                CHECK(off <= run.step_of_lines / 2 * 1.000001);
                CHECK(std::abs(read.lines[l].force[p] - line.force[p]) <=
                      1.001 * half_code(line.force[p], read.top_of_lines));
            }
        }
    }
    CHECK(data.stream().lines().size() == 4);
    CHECK(data.line_force().max() == Approx(20 * sample.frame(39).time));
    CHECK(run_of(page_of(data, {}))["lines"][1] == nlohmann::json{{"name", "cable <&>"}, {"kind", "cable"}});
}

TEST_CASE("without joints, ties, cables and springs a frame has one more byte", "[unit][output]") {
    std::string bytes;
    LineStream().put_frame(Frame{}, bytes);
    CHECK(bytes == std::string(1, '\0'));
}

TEST_CASE("a node that is not finite, or infinitely far, harms no other", "[unit][output]") {
    OutputSample sample(1, 1, 6);
    PageData data;
    std::vector<Vec3> position;
    for (int i = 0; i < 3; ++i) {
        Frame frame = sample.frame(i);
        position.assign(frame.bodies[0].position.begin(), frame.bodies[0].position.end());
        if (i > 0) position[3] = {not_a_number, infinity, 1e300};
        frame.bodies[0].position = position;
        data.add(frame);
    }
    const ReadRun run = read_run(data.packed_frames());
    const ReadBody& body = run.frames[2].bodies[0];
    for (std::size_t vertex = 0; vertex < body.position.size(); ++vertex) {
        const auto node = static_cast<std::size_t>(run.shapes[0].node[vertex]);
        CHECK(body.position[vertex].allFinite());
        if (node != 3) CHECK((body.position[vertex] - position[node]).norm() < run.shapes[0].step);
    }
}

TEST_CASE("frames in which nothing changes cost next to nothing", "[unit][output]") {
    OutputSample sample(1, 3, 120);
    PageData data;
    data.add(sample.frame(30));
    const std::size_t first = data.packed_frames().size();
    for (int i = 0; i < 100; ++i) data.add(sample.frame(30));
    CHECK(data.packed_frames().size() < 2 * first);
}

TEST_CASE("bodies that come and go keep their number and are listed once", "[unit][output]") {
    OutputSample sample(3, 0, 30);
    PageData data;
    for (int i = 0; i < 30; ++i) data.add(sample.frame(i));
    const ReadRun run = read_run(data.packed_frames());
    const auto numbers = [&](std::size_t frame) {
        std::vector<std::size_t> list;
        for (const ReadBody& body : run.frames[frame].bodies) list.push_back(body.number);
        return list;
    };
    CHECK(numbers(0) == std::vector<std::size_t>{0, 1});
    CHECK(numbers(15) == std::vector<std::size_t>{0, 2, 1});
    CHECK(numbers(29) == std::vector<std::size_t>{2, 1});
    CHECK(data.stream().bodies().size() == 3);
    CHECK(data.stream().body_names()[2] == "\"quotes\" & <b>, \xff no UTF-8");
}

TEST_CASE("names cannot end the script that they stand in, and come back as they were", "[unit][output]") {
    OutputSample sample(3, 0, 6);
    PageData data;
    for (int i = 0; i < 6; ++i) data.add(sample.frame(i));
    const std::string page = page_of(data, sample.summary());
    // Scripts: run, frames, visual surfaces, three.js and player. Nothing else opens or ends a script.
    CHECK(count_of(page, "</script>") == 5);
    CHECK(text_of(page, "frames") == base64(data.packed_frames()));
    CHECK(page.find("<title>Balls into a bucket &lt;/title&gt; &amp; &quot;quotes&quot;</title>") != std::string::npos);
    const nlohmann::json run = run_of(page);
    CHECK(run["title"] == sample.summary().title);
    CHECK(run["bodies"][0] == "</script><script>document.documentElement.dataset.error='escaped'</script>");
    CHECK(run["bodies"][2] == "\"quotes\" & <b>, \xef\xbf\xbd no UTF-8");
    CHECK(run["report"]["state_hash"] == "0123456789abcdef");
    CHECK(run["rows"]["time"].size() == 6);
    CHECK(run["report"]["stages"].size() == 9);
}

TEST_CASE("the report of a page has the self-crossings, and the reason not to trust the run", "[unit][output]") {
    const PageSummary summary = OutputSample(1, 0, 2).summary();
    const nlohmann::json report = run_of(page_of({}, summary))["report"];
    CHECK(report["self_crossings"] ==
          nlohmann::json{"the surface of body '</dd> ring' crosses itself in up to 3 places, first found at 0.4 s and "
                         "last at 1 s"});
    CHECK(report["distrust"] == summary.report.distrust());
    CHECK(!summary.report.distrust().empty());
    const nlohmann::json trusted = run_of(page_of({}, {}))["report"];
    CHECK(trusted["self_crossings"] == nlohmann::json::array());
    CHECK(trusted["distrust"] == "");
}

TEST_CASE("the same run gives the same page, and numbers that are not finite become null", "[unit][output]") {
    const auto make = [] {
        OutputSample sample(2, 1, 5);
        PageData data;
        for (int i = 0; i < 5; ++i) data.add(sample.frame(i));
        return page_of(data, sample.summary());
    };
    CHECK(make() == make());

    PageData data;
    Frame frame;
    frame.energy.kinetic = not_a_number;
    data.add(frame);
    const nlohmann::json run = run_of(page_of(data, {}));
    CHECK(run["rows"]["kinetic"][0].is_null());
    CHECK(run["rows"]["elastic"][0] == 0);
}

TEST_CASE("a page that cannot be written is named", "[unit][output]") {
    try {
        write_page("/dev/null/page.html", PageData{}, {});
        FAIL("it was written");
    } catch (const SceneError& error) {
        CHECK(std::string(error.what()).find("/dev/null") != std::string::npos);
    }
}

}  // namespace skerry::test::output_page_test
