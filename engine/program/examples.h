// Examples and explanations at the end of the help of the commands.
#pragma once

namespace skerry {

inline constexpr const char* general_examples = R"(Examples:
  skerry run scenes/skittles.json                          simulate, and print a summary
  skerry run scenes/skittles.json --page skittles.html     also write a page that plays the run in a browser
  skerry view scenes/skittles.json                         simulate, and show the scene live in a browser
  skerry run scenes/bucket.json --out frames --stats s.json   frames for ParaView, statistics for scripts
  skerry inspect scenes/table.json                         sizes, step length, cost and problems of a scene
  skerry inspect bunny.msh                                 sizes, quality and problems of a mesh
  skerry fill bunny.obj bunny.msh --scene bunny.json       fill a surface with tetrahedra, and write a first scene
  skerry solve problem.hdf5 --tolerance 1e-6               solve a frictional contact problem of FCLIB
  skerry sweep examples/incline_sweep.json                 simulate a scene with many values, one case per core
  skerry study scenes/gripper.json --error 1%              error bars, and the cheapest settings for errors of 1 %

Exit codes: 0 success, 1 the simulation failed, the solver did not converge, or a run with --strict has warnings,
2 invalid input, 3 an output of a run could not be written, 4 the results of a run cannot be trusted, because surfaces
passed through each other or contacts stayed unsolved, 128 + n stopped by signal n.
`skerry COMMAND --help` describes the options of a command.)";

inline constexpr const char* run_examples = R"(Examples:
  skerry run scenes/skittles.json --seconds 2 --threads 2
  skerry run scenes/table.json --page table.html --frames-per-second 30
  skerry run scenes/skittles.json --film skittles.usd --film-color stress        open the film in Blender
  skerry run scenes/table.json --profile                                         also print the times of all stages
  skerry run scenes/bucket.json --contact-regions global --stats global.json     one contact region instead of many
  skerry run scenes/bucket.json --export-problems problems --export-every 100    then: skerry solve problems/FILE
  skerry run scenes/drop/drop_27.json --threads 1 --quiet --stats drop.json      no summary, only the file of statistics
  skerry run scenes/bucket.json --checkpoint bucket.skerry --every 0.5           if the run is killed, continue with:
  skerry run --restart bucket.skerry --checkpoint bucket.skerry --every 0.5

At the end the run prints a short summary: the scene, the computing time, the main results, warnings (reasons not to
rely on the result, each with a remedy) and the written files. A run refuses outputs that another run is writing; a file
whose name ends in .lock marks them. --profile adds step limits, solver statistics, energies,
the times of all stages and the hash of the final state. --stats writes all of these as JSON.

--restart reads the scene file, the settings, the simulated time of the run and the times of the frames from the
checkpoint. Give SCENE only if the scene file has moved. --seconds may be larger and --threads may differ. --stats then
covers the whole run, but the times of the stages begin at the checkpoint. --probes (CSV) and --out continue the earlier
files; use the same file and folder. --page, --film, --trace and --probes (HDF5) begin at the checkpoint.)";

inline constexpr const char* view_examples = R"(Examples:
  skerry view scenes/skittles.json                         opens the browser; Ctrl-C ends
  skerry view scenes/finger.json --paused --rate 0.1       waits for play, then ten times slower than real time
  skerry view scenes/bucket.json --rate 0                  as fast as possible
  skerry view scenes/table.json --no-open --port 8080      prints the address; with ssh -L 8080:127.0.0.1:8080 HOST
                                                           it also opens on another machine
  skerry view scenes/table.json --set materials.wood.E=1e6 a value of the scene is changed

In the browser you can orbit, pause, step, reset, choose slow motion and colours, pull bodies with the mouse, switch
gravity off, and move the sliders of the scene. Plots show its probes. The server listens on 127.0.0.1 only. The address
contains a secret token: who knows it can control the run, so do not pass it on. On a machine with other users give
--no-open, because they can read the arguments with which the browser is opened.
At the end the program prints the simulated time, the speed, and the numbers of frames sent and dropped.
Exit codes: 0 ended by Ctrl-C, by SIGTERM or after --seconds, 2 invalid input or a port in use.)";

inline constexpr const char* inspect_examples = R"(Examples:
  skerry inspect bunny.msh                                 sizes, quality, problems, tetrahedra that limit the step
  skerry inspect bunny.stl                                 shells, holes, crossings and other faults of a surface
  skerry inspect bunny.msh --repair better.msh             write a mesh of the same body with a longer step
  skerry inspect bunny.msh --repair better.msh --tolerance 0      new tetrahedra inside the unchanged surface
  skerry inspect scene.json --repair arm.msh --body arm    the mesh of the body "arm", with the step of its material
  skerry inspect scenes/skittles.json --json
  skerry inspect scenes/skittles.json --set materials.skittle.young_modulus=6e5

--repair uses Netgen to fill two surfaces with new tetrahedra: the unchanged surface, and the surface without very flat
triangles. The mesh with the longer stable step is written. If no new stable step is at least 5 % longer, or if the
surface moves by more than the tolerance, no file is written and the exit code is 1.)";

inline constexpr const char* fill_examples = R"(Examples:
  skerry fill bunny.obj bunny.msh                          keep the triangles of the surface if it has no faults
  skerry fill bunny.obj bunny.msh --edge 0.01              tetrahedra and triangles with edges of about 1 cm
  skerry fill scan.stl scan.msh --edge 0.01 --tolerance 0.005   allow the surface to move by 0.5 % of its size
  skerry fill part.stl part.msh --scale 0.001              a surface in millimetres
  skerry fill bone.stl skin.stl leg.msh                    two regions, if one surface lies inside the other
  skerry fill ball.stl ball.msh --cavities                 leave the inside of inner shells empty
From a surface to a film:
  skerry fill bunny.obj bunny.msh --scene bunny.json --material rubber_natural
  skerry run bunny.json --page bunny.html                  then open bunny.html in a browser

A surface without faults is filled by Netgen, which keeps its triangles. A surface with holes, crossings or other
faults, and one whose edges differ from --edge, is filled by fTetWild within the tolerance. `skerry inspect SURFACE`
lists the faults. Of several meshes the one with the longest stable step is written. Netgen is part of Skerry if
libnglib-dev was installed when Skerry was built. fTetWild is a Python package: pip install wildmeshing==0.4.1. Set
SKERRY_FILL_PYTHON to the Python interpreter that has it, if that is not python3.
Exit codes: 0 success, 2 the surface cannot be filled or another input is invalid, 1 other failures.)";

inline constexpr const char* sweep_examples =
    R"(CASES is a JSON file. It names a scene and the values with which to simulate the scene:

  {"scene": "incline.json",
   "set": {"seconds": 1},
   "grid": [{"name": "mu", "set": ["materials.block.friction", "colliders[0].friction"], "values": [0.2, 0.3, 0.4]},
            {"set": "materials.block.E", "from": 1e4, "to": 1e6, "count": 5, "spacing": "log"}]}

A "grid" gives all combinations of the values. Instead of a "grid", give a "list" of cases, each an object
{PLACE: VALUE, ...}, or "random" cases:

   "random": {"seed": 1, "count": 100, "parameters": [
       {"set": "materials.block.E", "distribution": "log_uniform", "from": 1e4, "to": 1e6},
       {"set": "bodies[0].position[2]", "distribution": "normal", "mean": 0.05, "deviation": 0.01}]}

PLACE is a place in the scene, as for `skerry run --set`. docs/sweep.md describes sweeps in detail, and
`skerry schema --sweep` prints all keys.

Examples:
  skerry sweep cases.json --dry-run                        list the cases, and which of them have a result
  skerry sweep cases.json --out results                    run the cases, one per core at a time
  skerry sweep cases.json --out results                    after Ctrl-C: run the cases that have no result yet
  mpirun -n 64 skerry sweep cases.json --out results       64 processes; process I runs cases I, I + 64, ...
  srun -n 64 skerry sweep cases.json --out results         the same with SLURM (also with sbatch --array=0-63)
  skerry sweep cases.json --out results --rank 0 --of 2    the first of two processes that you start yourself
  skerry sweep cases.json --out results --table            write the table of the existing results

Results: one file per case (case_000000.json, ...), written at the end of the case. When all cases have a result, two
more files are written: sweep.csv, a table for spreadsheets, and sweep.html, a page with the same table and a plot. A
case that fails, or whose scene is refused, also has a result. A case that was killed has no result and is run again.
Exit codes: 0 all cases of this process have a result, 1 a case has no result (with --strict also: a case failed, was
refused or has warnings), 2 invalid input, 3 a file could not be written, 128 + n stopped by signal n.)";

inline constexpr const char* study_examples = R"(Examples:
  skerry study scenes/gripper.json                         error bars of all probes, and the cheapest settings for 1 %
  skerry study scenes/gripper.json --error 5% --probe cube     only quantities of the probe "cube"
  skerry study scenes/gripper.json --budget 60             allow 60 times the time of one run, for finer meshes
  skerry study scenes/gripper.json                         after Ctrl-C: continue with the runs that ended
  skerry run out/gripper_study/cheapest.json               run the scene with the cheapest settings

A study runs the scene as it is, with finer and coarser meshes, shorter and longer steps, a smaller tolerance of the
contact solver, other elements, and twice with nodes moved by 1e-12 m. From the differences it computes an error bar for
the result of the scene as it is, and its parts by mesh, step and contacts. It names values without an error bar:
stresses that grow without limit as the mesh gets finer, and values that depend on tiny differences of the start.

Results in the folder --out: study.html, a page with plots; study.csv, a table; study.json, all numbers; cheapest.json,
a scene with the cheapest settings for the wanted error; and one file per run (run_scene.json, ...), written at its end.
Runs that do not fit into --budget are left out, and the report says so. docs/study.md describes the rules.
Exit codes: 0 success, 1 the scene itself cannot be run to its end, 2 invalid input, 3 a file could not be written,
128 + n stopped by signal n.)";

}  // namespace skerry
