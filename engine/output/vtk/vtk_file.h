// One VTK XML file: XML tags, followed by all arrays as raw bytes.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>

#include "components/types.h"

namespace skerry {

static_assert(std::endian::native == std::endian::little,
              "VTK files are written as LittleEndian, so the machine must be little-endian");

template <class T>
inline constexpr std::string_view vtk_type = "";
template <>
inline constexpr std::string_view vtk_type<double> = "Float64";
template <>
inline constexpr std::string_view vtk_type<float> = "Float32";
template <>
inline constexpr std::string_view vtk_type<std::int32_t> = "Int32";
template <>
inline constexpr std::string_view vtk_type<std::uint8_t> = "UInt8";

/// Returns the shortest text that reads back as the same number. The text does not depend on the locale.
std::string number_text(double value);

/// Named list of texts in the field data of a file. ParaView shows it as an array of strings.
struct VtkTexts {
    std::string_view name;
    std::span<const std::string> texts;
};

/// Builds a VTK XML file with appended data (VTK file formats, "XML file formats"): XML tags, then for each array its
/// number of bytes (64 bits) and its raw little-endian bytes. Raw bytes take a quarter less space than base64, and all
/// of VTK's own readers accept them.
class VtkFile {
public:
    /// `kind` is UnstructuredGrid or PolyData. The time is also stored in the field data, where ParaView finds it if
    /// the file is opened without the index of the series (.pvd).
    VtkFile(std::string_view kind, Real time, std::initializer_list<VtkTexts> texts = {});

    void open(std::string_view tag, std::string_view attributes = "");
    void close(std::string_view tag);

    /// Adds an array of `tuples` rows with `components` numbers each. fill(put) must call put(value) for every number,
    /// row by row.
    template <class T>
    void array(std::string_view name, int components, std::size_t tuples, auto&& fill) {
        begin_array(vtk_type<T>, name, components);
        const std::size_t bytes = tuples * static_cast<std::size_t>(components) * sizeof(T);
        const std::uint64_t count = bytes;
        append(&count, sizeof count);
        data_.reserve(data_.size() + bytes);
        const std::size_t end = data_.size() + bytes;
        fill([this](auto value) {
            const T stored = static_cast<T>(value);
            append(&stored, sizeof stored);
        });
        check_size(end);
    }

    /// Completes the file and writes it. The file appears under its name only when it is complete.
    void write(const std::filesystem::path& file);

private:
    void begin_array(std::string_view type, std::string_view name, int components);
    void append(const void* bytes, std::size_t count) { data_.append(static_cast<const char*>(bytes), count); }
    void check_size(std::size_t expected) const;

    std::string kind_;
    std::string tags_;
    std::string data_;
};

}  // namespace skerry
