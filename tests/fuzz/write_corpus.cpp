// Writes the seed corpus of the fuzzers, valid files of every kind, to FOLDER/READER/FILE.
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "random_scene.h"
#include "readers.h"
#include "tests/unit/engine/mesh_samples.h"

using namespace skerry;
using namespace skerry::test;

namespace {

namespace fs = std::filesystem;

void put(const fs::path& file, const std::string& content) {
    fs::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << content;
}

void put_meshes(const fs::path& folder, const std::string& name, const Mesh& mesh) {
    for (const SampleFile& file : all_sample_files(mesh)) {
        const std::string ending = fs::path(file.name).extension().string();
        const std::string reader = ending == ".msh"              ? "gmsh"
                                   : ending == ".inp"            ? "abaqus"
                                   : ending.starts_with(".mesh") ? "medit"
                                                                 : ending.substr(1);
        if (ending != ".node" && ending != ".ele") put(folder / reader / (name + file.name), file.content);
        if (ending == ".vtk") put(folder / "body" / (name + file.name), file.content);
        if (ending == ".obj") put(folder / "collider" / (name + file.name), file.content);
    }
    for (int first : {0, 1})
        put(folder / "tetgen" / (name + std::to_string(first)), node_file(mesh, first) + '\0' + ele_file(mesh, first));
}

const char* const small_scenes[] = {
    R"({"materials": {"m": {"E": 1e5, "mu": 0.3}}, "bodies": [
        {"mesh": {"box": {"size": [1, 1, 1], "cells": [1, 1, 1]}}, "material": "m"}]})",
    R"({"include": "other.json", "bodies": [{"name": "b", "mesh": {"file": "body.vtk", "scale": 2}, "material": "wood",
        "repeat": {"count": [2, 1, 1], "spacing": [1, 0, 0], "jitter": 0.1, "seed": 3}}],
        "colliders": [{"shape": {"mesh": {"file": "shape.obj"}}, "position": [0, 0, 9],
            "motion": {"keys": [{"time": 0}, {"time": 1, "position": [1, 0, 0]}]}}],
        "probes": [{"name": "p", "body": "b_0", "box": {"lower": [-9, -9, -9], "upper": [9, 9, 9]}}],
        "probe_step": 0.01, "frame_step": 0.1, "seconds": 1})"};

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: %s FOLDER\n", argv[0]);
        return 2;
    }
    const fs::path folder = argv[1];
    put_meshes(folder, "box_", mesh::box({0.1, 0.2, 0.3}, {1, 1, 1}));
    put_meshes(folder, "ball_", mesh::ball(0.1, 2));
    Mesh labelled = mesh::box({0.1, 0.2, 0.3}, {1, 1, 1});
    labelled.label = {1, 1, 2, 2, -3, -3};
    put_meshes(folder, "labels_", labelled);
    int number = 0;
    for (const char* scene : small_scenes) put(folder / "scene" / ("small_" + std::to_string(number++)), scene);
    for (std::uint64_t seed = 1; seed <= 40; ++seed)
        put(folder / "scene" / ("random_" + std::to_string(seed)), make_random_scene(seed).json);
    for (const std::string& problem : sample_problems()) put(folder / "problem" / std::to_string(number++), problem);
    put(folder / "problem_values" / "local", std::string(1, '\0'));
    put(folder / "problem_values" / "global", std::string(1, '\1'));
    put(folder / "saved" / "world", sample_saved_world());
    put(folder / "saved_values" / "smoothed", std::string(1, '\0'));
    put(folder / "saved_values" / "linear", std::string(1, '\1'));
    return 0;
}
