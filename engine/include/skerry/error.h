// The exception for bad input.
#pragma once

#include <stdexcept>
#include <string>

#pragma GCC visibility push(default)
namespace skerry {

/// Exception for bad input while a world is built or a file is read. The message names the file, the object, the field,
/// the value found and the value expected.
class SceneError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// The parts of the message of a SceneError. text() joins them to
/// "FILE: OBJECT: FIELD: found FOUND, expected EXPECTED (HINT)" and leaves out empty parts.
struct Complaint {
    std::string file, object, field, found, expected, hint;

    std::string text() const;
    [[noreturn]] void raise() const { throw SceneError(text()); }
};

}  // namespace skerry
#pragma GCC visibility pop
