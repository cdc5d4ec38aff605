#include <cstdio>
#include <optional>
#include <string>
#include <utility>

#include "engine/base/complaint.h"
#include "engine/base/write_file.h"
#include "engine/output/collect_frame.h"
#include "engine/output/film/drawn_surface.h"
#include "engine/output/film/usd_film.h"
#include "engine/output/writer.h"
#include "skerry/output.h"

namespace skerry {

namespace {

[[noreturn]] void refuse_film(const std::filesystem::path& file, const char* field, const std::string& found,
                              const std::string& expected) {
    refuse_in(file.string(), "film", field, found, expected);
}

/// Returns `file`. Throws SceneError unless it ends in .usd or .usdc and the settings are valid.
const std::filesystem::path& checked(const std::filesystem::path& file, const FilmSettings& settings) {
    require_extension(file, {".usd", ".usdc"});
    require_positive(file, "frame_step", settings.frame_step);
    if (settings.color_max) require_positive(file, "color_max", *settings.color_max);
    return file;
}

}  // namespace

struct FilmWriter::Impl {
    std::filesystem::path path;
    FileReplacement file;
    FilmColor color;
    UsdFilm usd;
    std::optional<Real> time{};  // time of the previous frame [s]

    Impl(const std::filesystem::path& place, const FilmSettings& settings)
        : path(checked(place, settings)),
          file(path),
          color(settings.color),
          usd(file.seekable_stream(), std::filesystem::absolute(path).parent_path(), settings) {}
};

FilmWriter::FilmWriter(const std::filesystem::path& file, const FilmSettings& settings)
    : impl_(new Impl(file, settings)) {}

FilmWriter::~FilmWriter() = default;

void FilmWriter::require_open() const {
    if (!impl_) refuse_film({}, "", "a film that was closed or could not be written", "a new FilmWriter");
}

void FilmWriter::add_frame(const World& world) {
    require_open();
    Impl& film = *impl_;
    if (film.time && !(world.time() > *film.time))
        refuse_film(film.path, "time of the frame", std::to_string(world.time()) + " s",
                    "a time after that of the previous frame, " + std::to_string(*film.time) + " s");
    film.time = world.time();
    try {
        film.usd.add(collect_frame(world, content_of(film.color)));
        film.file.require_written();
    } catch (...) {
        impl_.reset();  // this removes the temporary file
        throw;
    }
}

Real FilmWriter::close() {
    require_open();
    const std::unique_ptr<Impl> film = std::move(impl_);
    const Real color_max = film->usd.close();
    film->file.commit();
    return color_max;
}

namespace {

/// Writes the film of a run. FilmWriter is made only in open(), because it needs the frame step of the run.
class FilmOutput final : public Writer {
public:
    FilmOutput(const std::filesystem::path& file, FilmColor color, std::optional<Real> color_max)
        : settings_{.color = color, .color_max = color_max}, file_(checked(file, settings_)) {}

    void open(World& world, const RunStart& start) override {
        settings_.frame_step = start.frame_step;
        writer_ = std::make_unique<FilmWriter>(file_, settings_);
        if (start.resumed()) writer_->add_frame(world);
    }
    void add_frame(const World& world) override { writer_->add_frame(world); }
    void close(const World&) override { color_max_ = writer_->close(); }
    std::string written() const override {
        std::string text =
            file_.string() + " (film; open it in Blender with File > Import > Universal Scene Description";
        if (settings_.color != FilmColor::none) {
            const Quantity quantity = quantity_of(settings_.color);
            char range[100];
            std::snprintf(range, sizeof range, "; colours: %s from 0 to %.3g %s", quantity.name, color_max_,
                          quantity.unit);
            text += range;
        }
        return text + ")";
    }

private:
    FilmSettings settings_;
    std::filesystem::path file_;
    std::unique_ptr<FilmWriter> writer_;
    Real color_max_ = 0;
};

/// Writes the state at the end of a run as a glTF file.
class GltfOutput final : public Writer {
public:
    GltfOutput(const std::filesystem::path& file, FilmColor color, std::optional<Real> color_max)
        : file_(file), color_(color), color_max_(color_max) {
        require_extension(file, {".glb"});
        require_gltf();
    }

    void close(const World& world) override { write_gltf(world, file_, color_, color_max_); }
    std::string written() const override { return file_.string() + " (last state; open it in a viewer of glTF)"; }

private:
    std::filesystem::path file_;
    FilmColor color_;
    std::optional<Real> color_max_;
};

}  // namespace

std::unique_ptr<Writer> usd_film(const std::filesystem::path& file, FilmColor color, std::optional<Real> color_max) {
    return std::make_unique<FilmOutput>(file, color, color_max);
}

std::unique_ptr<Writer> gltf_state(const std::filesystem::path& file, FilmColor color, std::optional<Real> color_max) {
    return std::make_unique<GltfOutput>(file, color, color_max);
}

}  // namespace skerry
