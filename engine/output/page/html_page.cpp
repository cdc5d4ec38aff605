// Writer for an HTML page that plays the run in a browser.
#include "engine/output/writer.h"
#include "skerry/output.h"

namespace skerry {

namespace {

class HtmlPage final : public Writer {
public:
    HtmlPage(const std::filesystem::path& file, const Scene& scene) : file_(file), title_(scene.name) {}

    void open(World& world, const RunStart& start) override {
        writer_ = std::make_unique<PageWriter>(file_, title_);
        if (start.resumed()) writer_->add_frame(world);
    }
    void add_frame(const World& world) override { writer_->add_frame(world); }
    void close(const World& world) override { writer_->close(world); }
    std::string written() const override { return file_.string() + " (open it in a browser)"; }

private:
    std::filesystem::path file_;
    std::string title_;
    std::unique_ptr<PageWriter> writer_;
};

}  // namespace

std::unique_ptr<Writer> html_page(const std::filesystem::path& file, const Scene& scene) {
    return std::make_unique<HtmlPage>(file, scene);
}

}  // namespace skerry
