// Texts of scenes for tests.
#pragma once

#include <string>

#include "tests/support/temporary_folder.h"

namespace skerry {

/// A small scene with `more` keys at the top level.
inline std::string scene_with(const std::string& more) {
    return R"({"materials": {"rubber": {"E": 1e5}}, "bodies": [
                  {"name": "ball", "mesh": {"ball": {"radius": 0.1, "resolution": 3}}, "material": "rubber"}])" +
           (more.empty() ? std::string() : ", " + more) + "}";
}

/// A small scene whose only body has `more` keys.
inline std::string body_with(const std::string& more) {
    return R"({"materials": {"rubber": {}}, "bodies": [
                  {"name": "block", "mesh": {"box": {"size": [1, 1, 1], "cells": [1, 1, 1]}}, "material": "rubber")" +
           (more.empty() ? std::string() : ", " + more) + "}]}";
}

/// A small scene whose only material has `keys`.
inline std::string material_with(const std::string& keys) {
    return R"({"materials": {"rubber": {)" + keys +
           R"(}}, "bodies": [{"mesh": {"ball": {"radius": 1, "resolution": 3}}, "material": "rubber"}]})";
}

}  // namespace skerry
