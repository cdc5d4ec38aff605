#include "jobs/trace.h"

#include <catch2/catch.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <thread>

#include "components/types.h"
#include "jobs/task_graph.h"
#include "tests/unit/jobs/executors.h"

namespace skerry::test::trace_test {

using nlohmann::json;

namespace {

json written(const Trace& trace) {
    std::ostringstream out;
    trace.write_json(out);
    return json::parse(out.str());
}

std::vector<json> events(const json& file, const std::string& phase) {
    std::vector<json> found;
    for (const json& event : file.at("traceEvents"))
        if (event.at("ph") == phase) found.push_back(event);
    return found;
}

}  // namespace

TEST_CASE("a trace without zones is a valid file that names its process and the worker that made it", "[unit]") {
    const json file = written(Trace());
    REQUIRE(events(file, "X").empty());
    REQUIRE(file.at("otherData").at("dropped_zones") == 0);
    const std::vector<json> names = events(file, "M");
    REQUIRE(names.size() == 2);
    REQUIRE(names[0].at("name") == "process_name");
    REQUIRE(names[1].at("name") == "thread_name");
    REQUIRE(names[1].at("args").at("name") == "worker 0");
}

TEST_CASE("a zone is written with its name, category, begin and duration in microseconds", "[unit]") {
    Trace trace;
    const Trace::Time begin = Trace::now();
    trace.add("dynamics/advance", begin, begin + std::chrono::nanoseconds(1234567));
    trace.add("quo\"te\\d\n", begin, begin);
    const std::vector<json> zones = events(written(trace), "X");
    REQUIRE(zones.size() == 2);
    REQUIRE(zones[0].at("name") == "dynamics/advance");
    REQUIRE(zones[0].at("cat") == "dynamics");
    REQUIRE(zones[0].at("tid") == 0);
    REQUIRE(zones[0].at("pid") == 1);
    REQUIRE(zones[0].at("dur").get<double>() == Approx(1234.567).epsilon(1e-12));
    REQUIRE(zones[0].at("ts").get<double>() >= 0);
    REQUIRE(zones[1].at("name") == "quo\"te\\d\n");
    REQUIRE(zones[1].at("dur") == 0.0);
}

TEST_CASE("zones nest and last as long as their scope", "[unit]") {
    Trace trace;
    {
        const TraceZone outer(&trace, "outer");
        const TraceZone inner(&trace, "inner");
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    const std::vector<json> zones = events(written(trace), "X");
    REQUIRE(zones.size() == 2);  // in the order in which they ended
    REQUIRE(zones[0].at("name") == "inner");
    REQUIRE(zones[0].at("dur").get<double>() >= 2000);
    REQUIRE(zones[1].at("ts").get<double>() <= zones[0].at("ts").get<double>());
    REQUIRE(zones[1].at("ts").get<double>() + zones[1].at("dur").get<double>() >=
            zones[0].at("ts").get<double>() + zones[0].at("dur").get<double>() - 0.002);  // 1 ns at both ends
}

TEST_CASE("a zone that was open when the trace was cleared begins before time 0", "[unit]") {
    Trace trace;
    {
        const TraceZone open(&trace, "open");
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        trace.clear();
    }
    const std::vector<json> zones = events(written(trace), "X");
    REQUIRE(zones.size() == 1);
    REQUIRE(zones[0].at("ts").get<double>() <= -1000);
}

TEST_CASE("a zone without a trace does nothing", "[unit]") {
    REQUIRE_NOTHROW(TraceZone(nullptr, "none"));
}

TEST_CASE("zones beyond the bound are counted and the file says how many", "[unit]") {
    Trace trace(3);
    for (int i = 0; i < 10; ++i) TraceZone(&trace, "zone");
    REQUIRE(trace.zone_count() == 3);
    REQUIRE(trace.dropped_count() == 7);
    const json file = written(trace);
    REQUIRE(events(file, "X").size() == 3);
    REQUIRE(file.at("otherData").at("dropped_zones") == 7);
    REQUIRE(file.at("otherData").at("max_zones_per_worker") == 3);
    trace.clear();
    REQUIRE(trace.zone_count() == 0);
    REQUIRE(trace.dropped_count() == 0);
    TraceZone(&trace, "zone");
    REQUIRE(trace.zone_count() == 1);
}

TEST_CASE("every thread has a row of its own, in each of two traces", "[unit]") {
    Trace first, second;
    for (int round = 0; round < 2; ++round) {
        TraceZone(&first, "here");
        TraceZone(&second, "here");
    }
    std::thread other([&] {
        for (int i = 0; i < 5; ++i) {
            TraceZone(&first, "there");
            TraceZone(&second, "there");
        }
    });
    other.join();
    for (const Trace* trace : {&first, &second}) {
        REQUIRE(trace->worker_count() == 2);
        std::map<std::string, std::set<int>> rows;
        for (const json& zone : events(written(*trace), "X")) rows[zone.at("name")].insert(zone.at("tid").get<int>());
        REQUIRE(rows["here"] == std::set<int>{0});
        REQUIRE(rows["there"] == std::set<int>{1});
    }
}

TEST_CASE("a graph records one zone for each stage that ran", "[unit]") {
    Column<Real> a, b;
    bool go = false;
    TaskGraph graph;
    graph.stage(
        "folder/first", [](std::span<Real>) {}, write(a));
    graph.stage(
        "folder/second", [](std::span<Real>) {}, write(b));
    graph.stage(
        "folder/never", [](std::span<Real>) {}, write(a), only_if([](bool may) { return may; }, value(go)));
    graph.compile();
    for (const ExecutorChoice& choice : executor_choices()) {
        CAPTURE(choice.text());
        Trace trace;
        const auto executor = choice.make();
        for (int run = 0; run < 5; ++run) graph.run(*executor, &trace);
        std::map<std::string, int> count;
        for (const json& zone : events(written(trace), "X")) ++count[zone.at("name")];
        REQUIRE(count == std::map<std::string, int>{{"folder/first", 5}, {"folder/second", 5}});
        REQUIRE(trace.worker_count() <= choice.workers);
    }
}

}  // namespace skerry::test::trace_test
