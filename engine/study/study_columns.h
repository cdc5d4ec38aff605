// Columns that a study records in each of its runs.
#pragma once

#include <string>
#include <vector>

#include "engine/scene/probe_recorder.h"
#include "skerry/scene.h"
#include "skerry/study.h"

namespace skerry {

/// Records the probes of a scene, and the default quantities: displacement, contact force and largest stress of each
/// body, and the energies. The first call of sample() records a row. Later calls do so only if a step was made since
/// the previous call.
class StudyRecorder {
public:
    /// `scene` must not have been changed or advanced since it was built, and must outlive the object.
    explicit StudyRecorder(Scene& scene);
    StudyRecorder(const StudyRecorder&) = delete;
    StudyRecorder& operator=(const StudyRecorder&) = delete;

    /// Must be called before the first step and after every call of World::advance.
    void sample();
    /// Times of the rows [s].
    std::vector<Real> time() const;
    std::vector<StudyColumn> columns() const;
    /// Name of the body of each column; empty for columns of no body or of several.
    std::vector<std::string> bodies() const;

private:
    /// Statistic that combines the values of several columns of `recorder_` into one value.
    enum class Statistic { mean, least, largest };
    struct ColumnSource {
        StudyColumn column;
        Statistic statistic = Statistic::mean;
        std::vector<std::size_t> recorder_columns;
        std::string body{};  // see bodies()
    };
    /// A column with the largest stress of a body or a part of it, and the node with the largest value in the run so
    /// far.
    struct Stress {
        std::size_t column = 0;  // column of the recorder
        StressProbe probe;
        std::vector<Vec3> start;  // positions of all nodes of the body at the start [m]
        Real largest = 0;         // largest value so far [Pa]
        Index node = no_index;    // node with this value
    };
    /// A probe that the study adds to the probes of the scene. `shown`: name of the probe in the columns of reports.
    struct DefaultProbe {
        RecordedProbe probe;
        std::string shown;
        BodyHandle body{};
        bool is_unattached = false;  // true for a body without attachments
    };

    static std::vector<DefaultProbe> default_probes(const Scene& scene);
    void add_sources(const std::vector<RecordedProbe>& of_scene);
    std::vector<StudyColumn> contact_columns() const;

    World& world_;
    std::vector<DefaultProbe> defaults_;
    Recorder recorder_;
    ProbeRecorder contacts_;  // records the probes with the quantity `contacts`
    bool many_bodies_ = false;
    Real size_ = 0;  // diagonal of the bounding box of all bodies at the start [m]
    std::vector<ColumnSource> sources_;
    std::vector<Stress> stresses_;
    std::size_t rows_ = 0;  // number of rows that are already included in `stresses_` and `contacts_`
};

/// Sets StudyColumn::reported to true for columns that a name selects, and to false for all others. If `names` is
/// empty, nothing is changed.
/// - NAME selects all columns of the probe NAME.
/// - NAME.QUANTITY selects one of its columns, or all components of a vector.
///
/// Throws SceneError for a name that selects no column. `file`: scene file, for the message.
void choose_columns_by_name(const std::vector<std::string>& names, const std::filesystem::path& file,
                            std::vector<StudyColumn>& columns);

}  // namespace skerry
