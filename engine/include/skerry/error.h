// The one exception of bad input.
#pragma once

#include <stdexcept>
#include <string>

#pragma GCC visibility push(default)
namespace skerry {

/// Bad input while building or reading: names the file, the object, the field, what was found and what was expected.
class SceneError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// The parts of such a message, put together in one way everywhere:
/// "FILE: OBJECT: FIELD: found FOUND, expected EXPECTED (HINT)". Empty parts are left out.
struct Complaint {
    std::string file, object, field, found, expected, hint;

    std::string text() const;
    [[noreturn]] void raise() const { throw SceneError(text()); }
};

}  // namespace skerry
#pragma GCC visibility pop
