// A series of VTK files from frames.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "engine/output/frame.h"

namespace skerry {

/// Whether a series of that name writes files of that file name.
bool is_series_file(std::string_view file_name, std::string_view name);

/// NAME_bodies_0000.vtu, NAME_contacts_0000.vtp and, whenever a collider came, went or moved, NAME_colliders_0000.vtp;
/// NAME.pvd lists them by time. Bodies and colliders are numbered in the order in which they were first seen, and keep
/// their number. Throws SceneError where an earlier series of the name cannot be replaced. The first frame takes the
/// place of all of an earlier series of the name: what is there under the names above is removed, and nothing else. A
/// frame that cannot be written whole leaves nothing.
class VtkSeries {
public:
    VtkSeries(std::filesystem::path folder, std::string name);
    /// As if `frames` frames had been written, `frame_step` seconds apart, `now` being the last: those that are there
    /// are listed.
    void go_on(const Frame& now, std::size_t frames, Real frame_step);
    /// In the order in which materials were added; "material NUMBER" of those that are not named.
    void name_materials(std::vector<std::string> names) { material_names_ = std::move(names); }
    void write_frame(const Frame& frame);
    void write_index() const;

private:
    struct Entry {
        Real time;         // s
        int part;          // 0 bodies, 1 contacts, 2 colliders
        std::string file;  // beside the index
    };

    void remove_earlier();
    void write_files(const Frame& frame);
    void number(const Frame& frame);
    void read_origins(const Frame& now);
    void write_bodies(const Frame& frame, const std::string& file) const;
    void write_contacts(const Frame& frame, const std::string& file) const;
    void write_colliders(const Frame& frame, const std::string& file) const;
    bool colliders_changed(const Frame& frame);
    void measure_patch(const Frame& frame);
    std::string frame_file(const char* what, const char* extension) const;

    std::vector<std::filesystem::path> earlier_;  // files of an earlier series of this name, its index first
    std::filesystem::path folder_;
    std::string name_;
    std::size_t frame_count_ = 0;
    std::map<BodyHandle, Index> body_number_;
    std::map<ColliderHandle, Index> collider_number_;
    std::vector<std::string> body_names_, collider_names_;  // by number
    std::vector<std::string> material_names_;
    std::map<BodyHandle, std::vector<Vec3>> origin_;                    // m, by node: where a body was first seen
    std::vector<std::pair<ColliderHandle, MotionKey>> colliders_prev_;  // as last written
    std::string colliders_file_;                                        // last written
    Vec3 patch_center_ = Vec3::Zero();                                  // m, of the pictures of planes
    Real patch_half_size_ = 0;                                          // m, 0: not measured yet
    std::vector<Entry> entries_;
};

}  // namespace skerry
