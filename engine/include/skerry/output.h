// Output of a run: a ParaView time series and a page that plays in a browser.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "skerry/scene.h"

#pragma GCC visibility push(default)
namespace skerry {

/// Writes frames for ParaView. NAME.pvd lists for each frame one .vtu of all bodies (displacement, velocity, speed,
/// stress, strain, numbers of body and material), one .vtp of the contacts (impulse, force, normal, gap, slip, state,
/// region) and one .vtp of the colliders, written anew when they have changed. Displacements are measured from the
/// position in which a body was first written. Stress is Cauchy stress [Pa], strain is Green strain. Both are given by
/// tetrahedron and by node, with components in the order of VTK: XX, YY, ZZ, XY, YZ, XZ. Field data hold the names of
/// bodies, materials and colliders by number. Files appear complete or not at all. Throws SceneError if the folder
/// cannot be written.
class VtkWriter {
public:
    VtkWriter(const std::filesystem::path& folder, const std::string& name);
    ~VtkWriter();
    /// Continues a series of `frames` frames, `frame_step` seconds apart. Those of them that are in the folder are
    /// listed in the .pvd, and the next frame gets the next number. Must be called before the first frame.
    void go_on(const World& world, std::size_t frames, Real frame_step);
    /// Names of the materials, in the order in which these were added; by default "material NUMBER". Must be called
    /// before the first frame.
    void name_materials(std::vector<std::string> names);
    void write_frame(const World& world);
    /// Writes the .pvd. The files of single frames can be opened without it.
    void close();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Collects frames and writes one self-contained HTML page that plays the run: bodies coloured by speed, stress or
/// strain, contacts by stick or slide, values under the pointer, pictures and videos, stage times and energies as
/// plots. Works offline; three.js is inlined. Keeps the frames compressed in memory, as they are in the page. Positions
/// are accurate to 1/32768 of a body's extent, and values are stored as square roots in 11 bits
/// (docs/decisions/0016-page-stream.md).
class PageWriter {
public:
    PageWriter(const std::filesystem::path& file, const std::string& title);
    ~PageWriter();
    void add_frame(const World& world);
    /// Writes the page at once, with the report of the whole run. Throws SceneError when it cannot be written.
    void close(const World& world);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace skerry
#pragma GCC visibility pop
