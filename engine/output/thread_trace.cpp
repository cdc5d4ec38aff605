// Writer for a trace of the activities of all threads.
#include <ostream>

#include "engine/base/write_file.h"
#include "engine/output/writer.h"

namespace skerry {

namespace {

class ThreadTrace final : public Writer {
public:
    explicit ThreadTrace(const std::filesystem::path& file) : file_(file) {}

    void open(World& world, const RunStart&) override { world.set_tracing(true); }
    void close(const World& world) override {
        write_file(file_, [&](std::ostream& out) { world.write_trace(out); });
    }
    std::string written() const override { return file_.string() + " (trace; open it in Perfetto)"; }

private:
    std::filesystem::path file_;
};

}  // namespace

std::unique_ptr<Writer> thread_trace(const std::filesystem::path& file) {
    return std::make_unique<ThreadTrace>(file);
}

}  // namespace skerry
