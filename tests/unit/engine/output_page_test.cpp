#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>

#include "engine/output/page/pack.h"
#include "engine/output/page/page_document.h"
#include "output_sample.h"
#include "skerry/error.h"
#include "systems/dynamics/elements/element_energy.h"
#include "tests/support/temporary_folder.h"

namespace {

using namespace skerry;

constexpr Real not_a_number = std::numeric_limits<Real>::quiet_NaN(), infinity = std::numeric_limits<Real>::infinity();

/// Takes values off the front of a packed frame.
struct Reader {
    const std::string& bytes;
    std::size_t at = 0;

    template <class T>
    T take() {
        T value;
        REQUIRE(at + sizeof value <= bytes.size());
        std::memcpy(&value, bytes.data() + at, sizeof value);
        at += sizeof value;
        return value;
    }
    Vec3 take_floats() {
        Vec3 v;
        for (int axis = 0; axis < 3; ++axis) v[axis] = take<float>();
        return v;
    }
    void fill_up() { at = (at + 3) / 4 * 4; }
};

std::string page_of(const PageData& data, const PageSummary& summary) {
    const TemporaryFolder folder;
    const std::filesystem::path file = folder.path() / "page.html";
    write_page(file, data, summary);
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

nlohmann::json run_of(const std::string& page) {
    const std::string opening = "<script type=\"application/json\" id=\"run\">";
    const std::size_t begin = page.find(opening) + opening.size();
    return nlohmann::json::parse(page.substr(begin, page.find("</script>", begin) - begin));
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

TEST_CASE("codes round to the nearest and stay in range whatever comes", "[unit][output]") {
    CHECK(code_of<std::uint8_t>(0, 2) == 0);
    CHECK(code_of<std::uint8_t>(2, 2) == 255);
    CHECK(code_of<std::uint8_t>(1, 2) == 128);
    CHECK(code_of<std::uint8_t>(3, 2) == 255);
    CHECK(code_of<std::uint8_t>(-1, 2) == 0);
    CHECK(code_of<std::uint8_t>(not_a_number, 2) == 0);
    CHECK(code_of<std::uint8_t>(infinity, 2) == 255);
    CHECK(code_of<std::uint16_t>(1, 0) == 0);
}

TEST_CASE("packed points come back within half a code, and a point that is not finite harms no other",
          "[unit][output]") {
    const std::vector<Vec3> points{{-1, 5, 3}, {2, 5, not_a_number}, {0.123, 5, -4}, {infinity, 0, 0}};
    std::string bytes;
    put_points(bytes, points);
    CHECK(bytes.size() % 4 == 0);
    Reader reader{bytes};
    const Vec3 lower = reader.take_floats(), extent = reader.take_floats();
    for (const Vec3& point : points)
        for (int axis = 0; axis < 3; ++axis) {
            const Real back = lower[axis] + extent[axis] * reader.take<std::uint16_t>() / 65535;
            // Half a code, and the rounding of the box to float.
            if (point.allFinite()) CHECK(std::abs(back - point[axis]) <= extent[axis] / 131070 + 1e-6);
        }
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

TEST_CASE("a packed frame gives back the bodies that it has, their places, speeds and stresses", "[unit][output]") {
    OutputSample sample(3, 1, 30);
    PageData data;
    data.add(sample.frame(0));
    const Frame& frame = sample.frame(0);
    REQUIRE(data.frames().size() == 1);
    Reader reader{data.frames()[0]};
    REQUIRE(reader.take<std::uint32_t>() == 2);  // ball 1 comes later
    CHECK(reader.take<std::uint32_t>() == 5);
    CHECK(reader.take<std::uint32_t>() == frame.contacts.size());
    for (std::uint32_t number = 0; number < 2; ++number) {
        const BodyFrame& body = frame.bodies[number];
        const std::vector<Index>& node = data.bodies()[number].node;
        CHECK(node.size() == body.position.size() - 1);  // all but the one inside
        CHECK(reader.take<std::uint32_t>() == number);
        const Real top_speed = reader.take<float>(), top_stress = reader.take<float>();
        const Vec3 lower = reader.take_floats(), extent = reader.take_floats();
        for (const Index n : node)
            for (int axis = 0; axis < 3; ++axis) {
                const Real back = lower[axis] + extent[axis] * reader.take<std::uint16_t>() / 65535;
                // 0.2 m / 131070, and float
                CHECK(back == Approx(body.position[static_cast<std::size_t>(n)][axis]).margin(1e-5));
            }
        reader.fill_up();
        for (const Index n : node)
            CHECK(top_speed * reader.take<std::uint8_t>() / 255 ==
                  Approx(body.velocity[static_cast<std::size_t>(n)].norm()).margin(top_speed / 500));
        reader.fill_up();
        Real largest = 0;
        for (std::size_t i = 0; i < node.size(); ++i)
            largest = std::max<Real>(largest, top_stress * reader.take<std::uint8_t>() / 255);
        reader.fill_up();
        CHECK(largest == Approx(top_stress));
        Real most = 0;
        for (const Mat3& stress : body.stress) most = std::max(most, von_mises(stress));
        CHECK(top_stress <= most * (1 + 1e-6));
    }
}

TEST_CASE("bodies that come and go keep their number and are listed once", "[unit][output]") {
    OutputSample sample(3, 0, 30);
    PageData data;
    std::vector<std::uint32_t> bodies;
    for (int i = 0; i < 30; ++i) {
        data.add(sample.frame(i));
        bodies.push_back(Reader{data.frames().back()}.take<std::uint32_t>());
    }
    CHECK(data.bodies().size() == 3);
    CHECK(bodies[0] == 2);
    CHECK(bodies[15] == 3);
    CHECK(bodies[29] == 2);
    CHECK(data.bodies()[2].name == "\"quotes\" & <b>, \xff no UTF-8");
}

TEST_CASE("names cannot end the script that they stand in, and come back as they were", "[unit][output]") {
    OutputSample sample(3, 0, 6);
    PageData data;
    for (int i = 0; i < 6; ++i) data.add(sample.frame(i));
    const std::string page = page_of(data, sample.summary());
    // Title, run, frames, three.js and player; nothing else opens or ends a script.
    CHECK(count_of(page, "</script>") == 3 + 6);
    CHECK(page.find("<title>Balls into a bucket &lt;/title&gt; &amp; &quot;quotes&quot;</title>") != std::string::npos);
    const nlohmann::json run = run_of(page);
    CHECK(run["title"] == sample.summary().title);
    CHECK(run["bodies"][0]["name"] == "</script><script>document.documentElement.dataset.error='escaped'</script>");
    CHECK(run["bodies"][2]["name"] == "\"quotes\" & <b>, \xef\xbf\xbd no UTF-8");
    CHECK(run["report"]["state_hash"] == "0123456789abcdef");
    CHECK(run["rows"]["time"].size() == 6);
    CHECK(run["report"]["stages"].size() == 9);
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
