// Writes a series of VTK files, several for each frame.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/separate_outputs.h"
#include "engine/output/frame.h"
#include "engine/output/shape_picture.h"

namespace skerry {

/// True if `file_name` is the name of a file that a series called `name` may write.
bool is_series_file(std::string_view file_name, std::string_view name);

/// Writes up to five files for each frame, and the index NAME.pvd, which lists the files by time:
/// - NAME_bodies_0000.vtu,
/// - NAME_contacts_0000.vtp,
/// - NAME_colliders_0000.vtp if a collider was added, removed or moved,
/// - NAME_lines_0000.vtp if the series has had joints, ties, cables or springs,
/// - NAME_visual_0000.vtp if a body has a visual surface.
///
/// Bodies, colliders and lines are numbered in the order of their first appearance, and their numbers never change. The
/// files of an earlier series with the same name, and no others, are removed before the first frame is written. Throws
/// SceneError if these files cannot be replaced. If a frame cannot be written completely, its files are removed.
class VtkSeries {
public:
    VtkSeries(std::filesystem::path folder, std::string name);
    /// Continues a series after `frames` frames, which were written `frame_step` seconds apart. Files of these frames
    /// are listed in the index if they still exist. `now` is the present state of the world.
    void go_on(const Frame& now, std::size_t frames, Real frame_step);
    /// Sets the names of the materials, in the order in which the materials were added. A material without a name is
    /// called "material NUMBER".
    void name_materials(std::vector<std::string> names) { material_names_ = std::move(names); }
    void write_frame(const Frame& frame);
    void write_index() const;

private:
    struct Entry {
        Real time;         // [s]
        int part;          // kind of file: 0 bodies, 1 contacts, 2 colliders, 3 lines, 4 visual surfaces
        std::string file;  // file name without folder; the index is in the same folder
    };

    void write_files(const Frame& frame);
    void number(const Frame& frame);
    void read_origins(const Frame& now);
    void write_bodies(const Frame& frame, const std::string& file) const;
    void write_contacts(const Frame& frame, const std::string& file) const;
    void write_colliders(const Frame& frame, const std::string& file) const;
    void write_lines(const Frame& frame, const std::string& file) const;
    bool colliders_changed(const Frame& frame);
    std::string frame_file(const char* part, const char* extension) const;

    std::filesystem::path folder_;
    std::string name_;
    EarlierFiles earlier_;  // files of an earlier series with the same name
    std::size_t frame_count_ = 0;
    std::map<BodyHandle, Index> body_number_;
    std::map<ColliderHandle, Index> collider_number_;
    std::map<decltype(LineFrame().key()), Index> line_number_;
    // names, indexed by body_number_, collider_number_ and line_number_
    std::vector<std::string> body_names_, collider_names_, line_names_;
    std::vector<std::string> material_names_;
    // Node positions of each body in its first frame, from which displacements are measured [m].
    std::map<BodyHandle, std::vector<Vec3>> origin_;
    // Colliders in the last file of colliders, and their poses in this file.
    std::vector<std::pair<ColliderHandle, MotionKey>> colliders_prev_;
    std::string colliders_file_;       // name of the last file of colliders
    std::optional<PlanePatch> patch_;  // displayed part of planes, determined in the first frame with bodies
    std::vector<Entry> entries_;
};

}  // namespace skerry
