// Writes a series of VTK files from frames.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "engine/output/frame.h"

namespace skerry {

/// True if a series called `name` may write a file with this file name.
bool is_series_file(std::string_view file_name, std::string_view name);

/// Writes NAME_bodies_0000.vtu, NAME_contacts_0000.vtp and, if a collider was added, removed or moved,
/// NAME_colliders_0000.vtp. NAME.pvd lists them by time. Bodies and colliders are numbered in the order of their first
/// appearance and keep their number. The first frame removes all files of an earlier series with the same name, as far
/// as they have the above names, and nothing else. Throws SceneError if they cannot be replaced. A frame that cannot
/// be written completely leaves no files.
class VtkSeries {
public:
    VtkSeries(std::filesystem::path folder, std::string name);
    /// Continues a series as if `frames` frames had been written, `frame_step` seconds apart, `now` being the last.
    /// Existing files of these frames are listed in the index.
    void go_on(const Frame& now, std::size_t frames, Real frame_step);
    /// Names in the order in which materials were added. Materials without a name become "material NUMBER".
    void name_materials(std::vector<std::string> names) { material_names_ = std::move(names); }
    void write_frame(const Frame& frame);
    void write_index() const;

private:
    struct Entry {
        Real time;         // [s]
        int part;          // 0 bodies, 1 contacts, 2 colliders
        std::string file;  // in the folder of the index
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

    std::vector<std::filesystem::path> earlier_;  // files of an earlier series with this name, its index first
    std::filesystem::path folder_;
    std::string name_;
    std::size_t frame_count_ = 0;
    std::map<BodyHandle, Index> body_number_;
    std::map<ColliderHandle, Index> collider_number_;
    std::vector<std::string> body_names_, collider_names_;  // by number
    std::vector<std::string> material_names_;
    std::map<BodyHandle, std::vector<Vec3>> origin_;  // positions at the first appearance of a body, by node [m]
    std::vector<std::pair<ColliderHandle, MotionKey>> colliders_prev_;  // as last written
    std::string colliders_file_;                                        // last file written
    Vec3 patch_center_ = Vec3::Zero();                                  // centre of the displayed part of planes [m]
    Real patch_half_size_ = 0;  // half size of the displayed part of planes; 0: not measured yet [m]
    std::vector<Entry> entries_;
};

}  // namespace skerry
