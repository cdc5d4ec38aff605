// Writer for frames in the VTK format of ParaView.
#include <exception>
#include <system_error>
#include <vector>

#include "engine/base/write_file.h"
#include "engine/output/vtk/vtk_series.h"
#include "engine/output/writer.h"
#include "skerry/error.h"
#include "skerry/output.h"

namespace skerry {

namespace {

class ParaviewFrames final : public Writer {
public:
    ParaviewFrames(const std::filesystem::path& folder, const Scene& scene)
        : folder_(folder), name_(scene.name), materials_(scene.materials) {}

    bool may_write(const std::filesystem::path& file) const override {
        const std::filesystem::path path = real_path(file);
        return path.parent_path() == real_path(folder_ / "frame").parent_path() &&
               is_series_file(path.filename().string(), name_);
    }
    void open(World& world, const RunStart& start) override {
        writer_ = std::make_unique<VtkWriter>(folder_, name_);
        writer_->name_materials(materials_);
        if (start.resumed()) writer_->go_on(world, start.frames, start.frame_step);
    }
    void add_frame(const World& world) override {
        try {
            writer_->write_frame(world);
        } catch (const std::exception&) {
            write_index_if_possible();
            throw;
        }
    }
    void close(const World&) override { writer_->close(); }
    std::string written() const override {
        return (folder_ / (name_ + ".pvd")).string() + " (frames; open it in ParaView)";
    }

private:
    /// Writes the index, so that the frames written so far can be opened. Does nothing if the index cannot be written.
    void write_index_if_possible() {
        try {
            writer_->close();
        } catch (const SceneError&) {  // the caller reports the error of the frame, so this error is ignored
        }
    }

    std::filesystem::path folder_;
    std::string name_;  // name of the scene
    std::vector<std::string> materials_;
    std::unique_ptr<VtkWriter> writer_;
};

}  // namespace

std::unique_ptr<Writer> paraview_frames(const std::filesystem::path& folder, const Scene& scene) {
    return std::make_unique<ParaviewFrames>(folder, scene);
}

}  // namespace skerry
