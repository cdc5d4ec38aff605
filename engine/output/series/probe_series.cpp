// Writer for the time series of probes, as CSV or HDF5 file.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/complaint.h"
#include "engine/output/writer.h"
#include "skerry/recorder.h"

namespace skerry {

namespace {

/// Records the rows of the time series. Derived classes write the rows to a file.
class ProbeSeries : public Writer {
public:
    ProbeSeries(const std::filesystem::path& file, const Scene& scene) : file_(file), probes_(scene.recorded) {}

    void open(World& world, const RunStart& start) override {
        recorder_.emplace(world, probes_, start.row_step);
        begin_file(world, start);
        if (!start.resumed()) recorder_->sample(world);
    }
    void sample(const World& world) override { recorder_->sample(world); }
    std::string written() const override { return file_.string() + " (time series of the probes)"; }

protected:
    virtual void begin_file(const World&, const RunStart&) {}
    const std::filesystem::path& file() const { return file_; }
    Recorder& recorder() { return *recorder_; }

private:
    std::filesystem::path file_;
    std::vector<RecordedProbe> probes_;
    std::optional<Recorder> recorder_;
};

/// Appends each row to the file as soon as it is recorded.
class CsvSeries final : public ProbeSeries {
public:
    using ProbeSeries::ProbeSeries;

protected:
    void begin_file(const World& world, const RunStart& start) override {
        recorder().stream_csv(file(), start.resumed() ? std::optional(world.time()) : std::nullopt);
    }
};

[[noreturn]] void refuse_series(const std::filesystem::path& file, const std::string& found,
                                const std::string& expected, const std::string& hint = {}) {
    refuse_in(file.string(), "--probes", {}, found, expected, hint);
}

/// Writes all rows at the end of the run. The file of a resumed run has only the rows after the checkpoint.
class Hdf5Series final : public ProbeSeries {
public:
    using ProbeSeries::ProbeSeries;
    void close(const World&) override { recorder().write_hdf5(file()); }

protected:
    void begin_file(const World&, const RunStart& start) override {
        if (start.resumed() && std::filesystem::exists(file()))
            refuse_series(file(), "an existing file, whose rows would be lost", "a new file",
                          "a resumed run cannot add rows to an HDF5 file; use another name, or .csv");
    }
};

}  // namespace

std::unique_ptr<Writer> probe_series(const std::filesystem::path& file, const Scene& scene) {
    const std::string extension = file.extension().string();
    const bool csv = extension == ".csv";
    if (!csv && extension != ".h5" && extension != ".hdf5")
        refuse_series(file, extension.empty() ? "a name without extension" : "the extension " + extension,
                      "the extension .csv, .h5 or .hdf5");
    if (scene.recorded.empty())
        refuse_series(file, "a scene without probes that record a time series", "at least one probe with a quantity",
                      "add a probe of motion, force, reaction, joint, tie, cable, cavity, spring, energy, stress or "
                      "volume to the "
                      "scene; see docs/outputs.md");
    if (csv) return std::make_unique<CsvSeries>(file, scene);
    return std::make_unique<Hdf5Series>(file, scene);
}

}  // namespace skerry
