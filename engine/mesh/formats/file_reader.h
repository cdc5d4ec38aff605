// Reader of a file that is loaded into memory as a whole. It reads lines, words and numbers, in text or binary form,
// one after the other. Error messages name the position in the file.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "components/types.h"

namespace skerry::mesh {

/// Type of binary numbers, for formats in which the file itself states the types of its numbers.
enum class NumberKind { bit, int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };
struct NumberType {
    NumberKind kind;
    std::size_t size;  // [bytes]

    bool is_real() const { return kind == NumberKind::float32 || kind == NumberKind::float64; }
};

class FileReader {
public:
    /// Reads the whole file. Throws SceneError if it does not exist, is not a regular file or cannot be read.
    explicit FileReader(const std::string& path);

    const std::string& path() const { return path_; }
    std::size_t remaining() const { return data_.size() - position_; }
    std::string_view rest() const { return std::string_view(data_).substr(position_); }
    /// Position in the file, counted from its start [bytes].
    std::size_t position() const { return position_; }
    /// Moves the reader to a position. Until the next item is read, error messages name the line of this position.
    void go_to(std::size_t position) {
        position_ = start_ = position < data_.size() ? position : data_.size();
        last_was_binary_ = false;
    }

    /// Sets the name of the file's section, for example "$Nodes". Later error messages contain it.
    void set_section(std::string section) {
        section_ = std::move(section);
        row_kind_ = nullptr;
    }
    /// Sets the row of the section for error messages, for example "node 3 of 14". set_section() clears the row.
    void set_row(const char* kind, std::size_t number, std::size_t count);

    // Lines.
    // -----------------------------------------------------------------------------------------------------------------

    /// True if only white space is left.
    bool at_end() const;
    /// Returns the next line, without its line end and surrounding white space.
    std::string_view line();
    /// Returns the next line that is not empty. At the end of the file throws SceneError, which says that `expected` is
    /// missing.
    std::string_view filled_line(const char* expected);
    /// Splits a line into words. The next call of words_of() overwrites the returned list.
    const std::vector<std::string_view>& words_of(std::string_view line);

    // Words and numbers of text.
    // ---------------------------------------------------------------------------------------------------

    /// Skips white space and line ends, then returns the next word. At the end of the file throws SceneError, which
    /// says that `expected` is missing.
    std::string_view word(const char* expected);
    /// Returns the word that word() would return, without changing the position; empty at the end of the file.
    std::string_view peek_word() const;
    Real parse_real(std::string_view text, const char* field) const;
    std::int64_t parse_integer(std::string_view text, const char* field) const;

    // Binary numbers.
    // --------------------------------------------------------------------------------------------------------------
    void set_swapped_bytes(bool swapped) { swapped_bytes_ = swapped; }
    template <class T>
    T binary(const char* field) {
        T value;
        begin_binary(sizeof(T), field);
        char bytes[sizeof(T)];
        for (std::size_t i = 0; i < sizeof(T); ++i)
            bytes[i] = data_[position_ + (swapped_bytes_ ? sizeof(T) - 1 - i : i)];
        std::memcpy(&value, bytes, sizeof(T));
        position_ += sizeof(T);
        return value;
    }
    void skip_bytes(std::size_t count, const char* field);
    /// Moves the reader to the byte after the next `mark` that is followed by white space or the end of the file.
    /// Binary numbers may stand directly before `mark`. Returns false and does not move the reader if there is no such
    /// `mark`.
    bool skip_behind(std::string_view mark);

    // Numbers of formats that have a text form and a binary form.
    // -----------------------------------------------------------------------------------------------------------------

    /// Sets whether real() and integer() read binary numbers. Until the first call they read words of text.
    void set_binary(bool binary) { binary_ = binary; }
    /// Reads the next number. `type`: type of the number in a binary file (not used in a text file); must not be `bit`.
    Real real(const NumberType& type, const char* field);
    /// Reads the next number. Throws SceneError if it is not an integer.
    std::int64_t integer(const NumberType& type, const char* field);

    // Checks.
    // -----------------------------------------------------------------------------------------------------------------

    /// Returns a row count that was read from the file. Throws SceneError if the count is negative or at least 2^29, or
    /// if the rest of the file is too short for so many rows of at least `bytes` bytes. This check prevents huge
    /// allocations because of a wrong count.
    std::size_t checked_count(std::int64_t count, std::size_t bytes, const char* field) const;
    /// Throws SceneError unless the number is finite.
    Real finite(Real value, const char* field) const;

    /// Throws SceneError. Its message names the file, the section, the row, the line (binary numbers: the byte),
    /// `field`, and the found and the expected value.
    [[noreturn]] void complain(std::string field, std::string found, std::string expected, std::string hint = {}) const;

private:
    void begin_binary(std::size_t size, const char* field);
    std::string place() const;

    std::string path_, data_, section_;
    const char* row_kind_ = nullptr;
    std::size_t row_number_ = 0, row_count_ = 0;
    std::size_t position_ = 0;
    std::size_t start_ = 0;  // position at which the last item read begins, for error messages
    bool last_was_binary_ = false;
    bool swapped_bytes_ = false;
    bool binary_ = false;
    std::vector<std::string_view> words_;
};

/// Converts a word of the file for use in an error message: in quotes, shortened, and with printable characters only.
std::string in_quotes(std::string_view text);

inline bool is_space(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f';
}
/// The text without white space at both ends.
std::string_view trimmed(std::string_view text);

std::string in_lower_case(std::string_view text);
std::string in_upper_case(std::string_view text);

}  // namespace skerry::mesh
