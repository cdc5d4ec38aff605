// Output of a run: a time series for ParaView, an HTML page that plays the run in a browser, a film, and a state as
// glTF.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

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
    /// Writes into `folder`, which is made if necessary. `name`: first part of the name of each file.
    VtkWriter(const std::filesystem::path& folder, const std::string& name);
    ~VtkWriter();
    /// Continues a series of `frames` frames that an earlier run has written to the folder, `frame_step` seconds apart.
    /// The index lists those of these frames whose files still exist, and the next frame gets the next number. Must be
    /// called before the first frame.
    void go_on(const World& world, std::size_t frames, Real frame_step);
    /// Sets the names of the materials, in the order in which the materials were added. The default name is "material
    /// NUMBER". Must be called before the first frame.
    void name_materials(std::vector<std::string> names);
    /// Writes the present state as the next frame.
    void write_frame(const World& world);
    /// Writes the index file NAME.pvd. The files of single frames can be opened without the index.
    void close();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Collects frames and writes one HTML page that plays the run. The page works offline, because it contains everything
/// that it needs, including three.js.
///
/// - It shows bodies coloured by speed, stress or strain, contacts by stick or slide, joints, ties, cables and springs
///   by force, values under the pointer, and plots of stage times and energies. It can export pictures and videos.
/// - The frames are kept in memory in the compressed form of the page (docs/decisions/0016-page-stream.md). Positions
///   are accurate to 1/32768 of the extent of their body. Values such as speed or stress are stored as square roots
///   with 11 bits, which is finer for small values.
class PageWriter {
public:
    /// The page is written to `file` by close().
    PageWriter(const std::filesystem::path& file, const std::string& title);
    ~PageWriter();
    /// Adds the present state as a frame.
    void add_frame(const World& world);
    /// Writes the page, with the report of the whole run. Throws SceneError if the page cannot be written.
    void close(const World& world);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Quantity that the colours of a film show.
enum class FilmColor {
    none,     // no quantity: each body has its own colour
    stress,   // von Mises stress of the nodes [Pa]
    speed,    // speed of the nodes [m/s]
    contact,  // contact pressure [Pa]
};
template <>
struct EnumNames<FilmColor> {
    static constexpr std::array<std::pair<FilmColor, std::string_view>, 4> table{{
        {FilmColor::none, "none"},
        {FilmColor::stress, "stress"},
        {FilmColor::speed, "speed"},
        {FilmColor::contact, "contact"},
    }};
};

/// Settings of a film in USD format.
struct FilmSettings {
    Real frame_step = 1.0 / 60;         // simulated time between two successive frame numbers of the film [s]
    FilmColor color = FilmColor::none;  // quantity that the colours show
    // Value at the upper end of the colour scale, > 0, in the unit of the quantity. The scale begins at zero. If empty,
    // the end is chosen so that 99 % of the values above zero are below it.
    std::optional<Real> color_max{};
};

/// Writes a film in the binary format of USD (Universal Scene Description), which Blender, Houdini and other programs
/// open without plug-ins (docs/outputs.md).
///
/// The file has a mesh for each body and each collider, with velocities for motion blur. The quantity of FilmColor is a
/// colour and a number at each vertex: von Mises stress [Pa], speed [m/s], or contact pressure [Pa].
///
/// Each frame is written immediately to a temporary file, which close() moves to its place. The film is therefore
/// complete or does not exist.
class FilmWriter {
public:
    /// Throws SceneError if the file cannot be written, if its extension is not .usd or .usdc, or if a setting is
    /// wrong.
    FilmWriter(const std::filesystem::path& file, const FilmSettings& settings);
    ~FilmWriter();
    /// Adds the present state as a frame. Throws SceneError if the time is not later than that of the previous frame,
    /// or if the frame cannot be written. After an error the film is lost.
    void add_frame(const World& world);
    /// Completes the film. Returns the value at the upper end of the colour scale (FilmSettings::color_max).
    Real close();

private:
    struct Impl;
    void require_open() const;
    std::unique_ptr<Impl> impl_;
};

/// Writes the present state as a binary glTF file (.glb). The file has a mesh for each body and each collider, with
/// normals. `color` and `color_max`: see FilmSettings. Textures are included if they are PNG or JPEG images. glTF has
/// the y axis up, so the meshes are rotated by -90 degrees about x.
void write_gltf(const World& world, const std::filesystem::path& file, FilmColor color = FilmColor::none,
                std::optional<Real> color_max = {});

}  // namespace skerry
#pragma GCC visibility pop
