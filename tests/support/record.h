// What tests leave behind for the tables of docs/: one line of JSON a row.
#pragma once

#include <string>

#include "components/types.h"

namespace skerry::test {

class RecordLine {
public:
    RecordLine& add(const char* key, const std::string& text);
    RecordLine& add(const char* key, Real number);  // finite
    RecordLine& add(const char* key, int number);

    /// Appends the line to the file of this process in the folder that the environment variable SKERRY_RECORD names;
    /// without it, does nothing. One file a process: test programs may run side by side.
    void write() const;

private:
    std::string& next(const char* key);

    std::string text_;
};

}  // namespace skerry::test
