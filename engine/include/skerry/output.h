// Output of a run: a time series for ParaView, and an HTML page that plays the run in a browser.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "skerry/scene.h"

#pragma GCC visibility push(default)
namespace skerry {

/// Writes frames for ParaView. The index file NAME.pvd lists these files for each frame:
/// - one .vtu file of all bodies, with displacement, velocity, speed, stress, strain, and the numbers of body and
///   material;
/// - one .vtp file of the contacts, with impulse, force, normal, gap, slip, state and region;
/// - one .vtp file of the colliders, which is written again only when a collider has changed;
/// - one .vtp file of joints, ties, cables and springs, with kind and force, if there are any;
/// - one .vtp file of visual surfaces, with texture coordinates, displacement, velocity and stress, if there are any.
///
/// Displacements are measured from the position in which a body was first written. Stress is Cauchy stress [Pa], strain
/// is Green strain. Both are given by tetrahedron and by node, with components in the order of VTK: XX, YY, ZZ, XY, YZ,
/// XZ. Field data map the numbers of bodies, materials and colliders to names. Files appear complete or not at all.
/// Throws SceneError if the folder cannot be written.
class VtkWriter {
public:
    VtkWriter(const std::filesystem::path& folder, const std::string& name);
    ~VtkWriter();
    /// Continues an existing series of `frames` frames, `frame_step` seconds apart. Frames of this series whose files
    /// are in the folder are listed in the .pvd file, and the next frame gets the next number. Must be called before
    /// the first frame.
    void go_on(const World& world, std::size_t frames, Real frame_step);
    /// Sets the names of the materials, in the order in which the materials were added. The default name is "material
    /// NUMBER". Must be called before the first frame.
    void name_materials(std::vector<std::string> names);
    void write_frame(const World& world);
    /// Writes the index file NAME.pvd. The files of single frames can be opened without the index.
    void close();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Collects frames and writes one self-contained HTML page that plays the run. The page shows bodies coloured by speed,
/// stress or strain, contacts by stick or slide, joints, ties, cables and springs by force, values under the pointer,
/// and plots of stage times and energies. It can export pictures and videos. It works offline, because three.js is
/// inlined. The frames are kept in memory in the compressed form of the page. Positions are accurate to 1/32768 of a
/// body's extent, and values are stored as square roots in 11 bits (docs/decisions/0016-page-stream.md).
class PageWriter {
public:
    PageWriter(const std::filesystem::path& file, const std::string& title);
    ~PageWriter();
    void add_frame(const World& world);
    /// Writes the page, with the report of the whole run. Throws SceneError if the page cannot be written.
    void close(const World& world);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace skerry
#pragma GCC visibility pop
