#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <utility>

#include "engine/output/collect_frame.h"
#include "engine/output/film/usd_film.h"
#include "engine/output/write_file.h"
#include "engine/output/writer.h"
#include "skerry/error.h"
#include "skerry/output.h"

namespace skerry {

namespace {

[[noreturn]] void refuse_film(const std::filesystem::path& file, const std::string& field, const std::string& found,
                              const std::string& expected, const std::string& hint = {}) {
    Complaint{
        .file = file.string(), .object = "film", .field = field, .found = found, .expected = expected, .hint = hint}
        .raise();
}

/// Throws if the settings cannot be those of a film. Otherwise returns the file.
std::filesystem::path film_path(const std::filesystem::path& file, const FilmSettings& settings) {
    if (const std::string extension = file.extension().string(); extension != ".usd" && extension != ".usdc")
        refuse_film(file, {}, extension.empty() ? "no extension" : "the extension " + extension, ".usd or .usdc",
                    "the program usdcat of USD converts films to .usda and .usdz");
    const auto require_positive = [&](const char* field, Real value) {
        if (!(value > 0 && std::isfinite(value))) refuse_film(file, field, std::to_string(value), "a number above 0");
    };
    require_positive("frame_step", settings.frame_step);
    if (settings.color_max) require_positive("color_max", *settings.color_max);
    return file;
}

}  // namespace

struct FilmWriter::Impl {
    std::filesystem::path path;
    FileReplacement file;
    UsdFilm usd;
    std::optional<Real> time{};  // of the previous frame [s]

    Impl(const std::filesystem::path& place, const FilmSettings& settings)
        : path(film_path(place, settings)), file(path), usd(file.seekable_stream(), settings) {}
};

FilmWriter::FilmWriter(const std::filesystem::path& file, const FilmSettings& settings)
    : impl_(new Impl(file, settings)) {}

FilmWriter::~FilmWriter() = default;

void FilmWriter::require_open() const {
    if (!impl_) refuse_film({}, {}, "a film that was closed or could not be written", "a new FilmWriter");
}

void FilmWriter::add_frame(const World& world) {
    require_open();
    Impl& film = *impl_;
    if (film.time && !(world.time() > *film.time))
        refuse_film(film.path, "time of a frame", std::to_string(world.time()) + " s",
                    "a time after that of the previous frame, " + std::to_string(*film.time) + " s");
    try {
        film.usd.add(collect_frame(world));
        film.file.require_written();
    } catch (...) {
        impl_.reset();  // which removes the temporary file
        throw;
    }
    film.time = world.time();
}

Real FilmWriter::close() {
    require_open();
    const std::unique_ptr<Impl> film = std::move(impl_);
    const Real color_max = film->usd.close();
    film->file.commit();
    return color_max;
}

namespace {

/// Film of a run.
class UsdOutput final : public Writer {
public:
    UsdOutput(const std::filesystem::path& file, FilmColor color, std::optional<Real> color_max)
        : file_(film_path(file, {})), settings_{.color = color, .color_max = color_max} {}

    void open(World& world, const RunStart& start) override {
        settings_.frame_step = start.frame_step;
        writer_ = std::make_unique<FilmWriter>(file_, settings_);
        if (start.resumed()) writer_->add_frame(world);
    }
    void add_frame(const World& world) override { writer_->add_frame(world); }
    void close(const World&) override { color_max_ = writer_->close(); }
    std::string written() const override {
        std::string text = file_.string() + " (film; open it in Blender: File > Import > Universal Scene Description";
        if (settings_.color != FilmColor::none) {
            const Quantity quantity = quantity_of(settings_.color);
            char range[100];
            std::snprintf(range, sizeof range, "; colours: %s from 0 to %.3g %s", quantity.name, color_max_, quantity.unit);
            text += range;
        }
        return text + ")";
    }

private:
    std::filesystem::path file_;
    FilmSettings settings_;
    std::unique_ptr<FilmWriter> writer_;
    Real color_max_ = 0;
};

}  // namespace

std::unique_ptr<Writer> usd_film(const std::filesystem::path& file, FilmColor color, std::optional<Real> color_max) {
    return std::make_unique<UsdOutput>(file, color, color_max);
}

}  // namespace skerry
