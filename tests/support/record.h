// Results that tests record for the tables of docs/: one line of JSON per row.
#pragma once

#include <string>

#include "components/types.h"

namespace skerry::test {

class RecordLine {
public:
    RecordLine& add(const char* key, const std::string& text);
    RecordLine& add(const char* key, Real number);  // finite
    RecordLine& add(const char* key, int number);

    /// Appends the line to a file in the folder named by the environment variable SKERRY_RECORD; does nothing without
    /// it. Each process has its own file because test programs may run side by side.
    void write() const;

private:
    std::string& next(const char* key);

    std::string text_;
};

}  // namespace skerry::test
