// The exception for bad input.
#pragma once

#include <memory>
#include <stdexcept>
#include <string>

#pragma GCC visibility push(default)
namespace skerry {

/// The parts of the message of a SceneError. text() joins them into "FILE: OBJECT: FIELD: found FOUND, expected
/// EXPECTED (HINT)" and leaves out empty parts.
struct Complaint {
    std::string file, object, field, found, expected, hint;  // parts of the message; each may be empty

    /// Returns the message.
    std::string text() const;
    /// Throws a SceneError with these parts.
    [[noreturn]] void raise() const;
};

/// Exception for bad input: in a file, or in an argument of a function that builds, changes or reads a world. The
/// message names the file, the object, the field, the value found and the value expected.
class SceneError : public std::runtime_error {
public:
    /// `text`: the message. `complaint`: those parts of the message that are known separately.
    explicit SceneError(const std::string& text, Complaint complaint = {});
    explicit SceneError(const Complaint& complaint) : SceneError(complaint.text(), complaint) {}

    /// Returns the parts of the message. All are empty if the error was made from a text alone. The message can name
    /// more places than the parts do, for example a scene file and a mesh file that it uses.
    const Complaint& complaint() const noexcept { return *complaint_; }

private:
    std::shared_ptr<const Complaint> complaint_;  // shared, so that copying the exception never throws
};

}  // namespace skerry
#pragma GCC visibility pop
