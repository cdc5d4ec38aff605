// Output of a run: a ParaView time series and a page that plays in a browser.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "skerry/scene.h"

#pragma GCC visibility push(default)
namespace skerry {

/// Writes frames for ParaView: NAME.pvd with one .vtu of all bodies (displacement, velocity, speed, stress, strain,
/// numbers of body and material) and one .vtp of the contacts (impulse, force, normal, gap, slip, state, region) a
/// frame. Displacements are from where a body was first seen. Stress is Cauchy's in Pa, strain Green's, both by
/// tetrahedron and by node; components as VTK has them: XX, YY, ZZ, XY, YZ, XZ. Names of bodies, materials and
/// colliders, by number, are texts in the field data. Files appear complete or not at all. Throws SceneError when the
/// folder cannot be written.
class VtkWriter {
public:
    VtkWriter(const std::filesystem::path& folder, const std::string& name);
    ~VtkWriter();
    /// Goes on with a series that has `frames` frames by now, `frame_step` seconds apart: those of them that are in the
    /// folder are in the .pvd, and the next one has the next number. Before the first frame.
    void go_on(const World& world, std::size_t frames, Real frame_step);
    /// In the order in which materials were added; by default they are called "material NUMBER". Before the first
    /// frame.
    void name_materials(std::vector<std::string> names);
    void write_frame(const World& world);
    /// Writes the .pvd; frames written so far open without it, too.
    void close();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Collects frames and writes one self-contained HTML page that plays the run: bodies coloured by speed, stress or
/// strain, contacts by stick or slide, values under the pointer, pictures and videos, stage times and energies as
/// plots. Works offline; three.js is inlined. Keeps the frames compressed in memory, as they are in the page: places to
/// 1/32768 of a body's extent, values to 11 bits of their root (docs/decisions/0016-page-stream.md).
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
