// Writes the crate format, the binary form of USD (Universal Scene Description), value by value.
#pragma once

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace skerry {

/// Types of values with their numbers in the format (pxr/usd/sdf/crateDataTypes.h of OpenUSD).
enum class CrateType : std::uint8_t {
    boolean = 1,
    int32 = 3,
    float32 = 8,
    float64 = 9,
    string = 10,
    token = 11,
    asset_path = 12,
    quaternion_float = 17,
    vec2_double = 19,
    vec2_float = 20,
    vec3_double = 23,
    vec3_float = 24,
    token_list_op = 32,
    path_list_op = 34,
    token_vector = 41,
    specifier = 42,
    variability = 44,
    time_samples = 46,
    double_vector = 48,
};

/// A value in the 64-bit encoding of the format: its type, and either the value itself or its position in the file.
enum class CrateValue : std::uint64_t {};

/// Kinds of specs (entries of the scene description) with their numbers in the format.
enum class SpecKind : std::uint8_t { attribute = 1, prim = 6, root = 7, relationship = 8 };

/// A prim, an attribute or a relationship. The children of a prim are its properties and prims.
struct CrateSpec {
    SpecKind kind = SpecKind::prim;
    std::string name;
    std::vector<std::pair<std::string, CrateValue>> fields{};
    std::vector<CrateSpec> children{};
};

/// Writes a crate file of version 0.8.0, which every program with OpenUSD reads since 2018. Each value is written at
/// once, so that memory holds only its CrateValue (8 bytes). The tables must be LZ4 blocks, but are written without
/// compression, because they are short compared with the values.
class CrateFile {
public:
    /// `file` must be empty, and must support writing, reading and seeking. It must outlive the object.
    explicit CrateFile(std::iostream& file);

    CrateValue token(std::string_view text) { return inlined(CrateType::token, token_index(text)); }
    CrateValue asset_path(std::string_view text) { return inlined(CrateType::asset_path, token_index(text)); }
    CrateValue string(std::string_view text);
    CrateValue boolean(bool value) { return inlined(CrateType::boolean, value ? 1 : 0); }
    CrateValue float32(float value);
    CrateValue float64(double value) { return scalar(CrateType::float64, value); }
    /// Value of the specifier `def`, which defines a prim.
    CrateValue defines() { return inlined(CrateType::specifier, 0); }
    /// Value "uniform" of the variability of an attribute, which may then have no time samples.
    CrateValue uniform() { return inlined(CrateType::variability, 1); }
    /// Writes a single value that is stored in the file as in memory, such as a quaternion.
    template <class T>
    CrateValue scalar(CrateType type, const T& value) {
        return write_scalar(type, std::as_bytes(std::span<const T, 1>(&value, 1)));
    }
    /// Writes an array whose elements are stored in the file as in memory.
    template <class T>
    CrateValue array(CrateType type, std::span<const T> values) {
        return write_array(type, values.size(), std::as_bytes(values));
    }
    CrateValue token_array(std::span<const std::string> texts);
    CrateValue token_vector(std::span<const std::string> texts);
    /// Returns an edit of a list in USD: one token is put before the items that weaker layers (files with lower
    /// priority) give to the list.
    CrateValue prepended_token(std::string_view text);
    /// Returns an edit of a list in USD that sets the path to which a relationship or a connection points.
    CrateValue target(std::string_view path);
    CrateValue times(std::span<const double> times);
    /// Returns the time samples of an attribute. `times`: result of times() with as many times as `values` has entries.
    CrateValue time_samples(CrateValue times, std::span<const CrateValue> values);
    /// Reads an array back from the file. T must be the type with which the array was written.
    template <class T>
    std::vector<T> read_array(CrateValue value) {
        std::vector<T> values(begin_read(value));
        read(std::as_writable_bytes(std::span(values)));
        end_read();
        return values;
    }
    /// Completes the file. `root`: the whole scene, of kind SpecKind::root. close() adds the fields "properties" and
    /// "primChildren", which list the children of a spec, so the caller must not add them.
    void close(CrateSpec root);

private:
    struct Tables;

    static CrateValue inlined(CrateType type, std::uint32_t payload);
    static CrateValue stored(CrateType type, std::uint64_t position);
    std::uint32_t token_index(std::string_view text);
    std::uint32_t path_index(const std::string& path);
    void write(std::span<const std::byte> bytes);
    template <class T>
    void put(const T& value) {
        write(std::as_bytes(std::span<const T, 1>(&value, 1)));
    }
    void put_tokens(std::span<const std::string> texts);
    void align();
    CrateValue write_scalar(CrateType type, std::span<const std::byte> bytes);
    CrateValue write_array(CrateType type, std::size_t count, std::span<const std::byte> bytes);
    /// Moves the reading position to the elements of an array, and returns their number. Call end_read after reading.
    std::uint64_t begin_read(CrateValue array);
    void read(std::span<std::byte> bytes);
    void end_read();
    void put_packed(std::string_view bytes);
    void put_integers(std::span<const std::int32_t> values);
    void list_children(CrateSpec& spec);
    void collect(const CrateSpec& spec, const std::string& path, bool has_sibling, Tables& tables);

    std::iostream& file_;
    std::uint64_t size_ = 0;  // number of bytes written
    std::vector<std::string> tokens_;
    std::map<std::string, std::uint32_t, std::less<>> token_index_;
    std::vector<std::uint32_t> strings_;  // token number of each string
    std::map<std::string, std::uint32_t> path_index_;
};

}  // namespace skerry
