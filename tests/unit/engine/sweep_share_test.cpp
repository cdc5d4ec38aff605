// Selection of the cases for a process from the variables of its launcher.
#include <catch2/catch.hpp>
#include <map>
#include <string>

#include "engine/program/sweep/share.h"
#include "skerry/error.h"

namespace skerry::test::sweep_share_test {

namespace {

using Variables = std::map<std::string, std::string>;

skerry::Share share(const Variables& variables, std::optional<int> rank = {}, std::optional<int> of = {}) {
    return skerry::share_of(rank, of, [&](const char* name) -> const char* {
        const auto found = variables.find(name);
        return found == variables.end() ? nullptr : found->second.c_str();
    });
}

Variables with(Variables variables, const Variables& more) {
    for (const auto& [name, value] : more) variables[name] = value;
    return variables;
}

const Variables mpirun{{"OMPI_COMM_WORLD_RANK", "3"}, {"OMPI_COMM_WORLD_SIZE", "8"}};
const Variables mpich{{"PMI_RANK", "1"}, {"PMI_SIZE", "4"}};
const Variables srun{{"SLURM_PROCID", "2"}, {"SLURM_NTASKS", "16"}};
const Variables job_array{{"SLURM_ARRAY_TASK_ID", "5"}, {"SLURM_ARRAY_TASK_COUNT", "10"}};

void check(const skerry::Share& found, int rank, int of) {
    CHECK(found.rank == rank);
    CHECK(found.of == of);
}

}  // namespace

TEST_CASE("a process that nobody counts has all cases", "[unit]") {
    check(share({}), 0, 1);
    CHECK(share({}).said_by.empty());
    CHECK(share({}).has(17));
    check(share({{"PMI_RANK", "3"}}), 0, 1);  // the number of processes is unknown
    check(share({{"PMI_RANK", ""}, {"PMI_SIZE", ""}}), 0, 1);
}

TEST_CASE("every launcher says which process this is", "[unit]") {
    check(share(mpirun), 3, 8);
    check(share(mpich), 1, 4);
    check(share(srun), 2, 16);
    check(share(job_array), 5, 10);
    CHECK(share(mpirun).cores == 1);
    CHECK_FALSE(share(job_array).cores);
    CHECK(share(with(srun, {{"SLURM_CPUS_PER_TASK", "4"}})).cores == 4);
}

TEST_CASE("the command line wins", "[unit]") {
    check(share(with(mpirun, job_array), 1, 2), 1, 2);
}

TEST_CASE("the launcher nearest to the process wins: mpirun starts its daemons by srun", "[unit]") {
    check(share(with(srun, mpirun)), 3, 8);
}

TEST_CASE("a batch script of SLURM is one process, whatever it may start", "[unit]") {
    const Variables batch{{"SLURM_JOB_ID", "7"}, {"SLURM_PROCID", "0"}, {"SLURM_NTASKS", "16"}};
    check(share(batch), 0, 1);
    const Variables step = with(batch, {{"SLURM_STEP_ID", "0"}, {"SLURM_PROCID", "3"}, {"SLURM_STEP_NUM_TASKS", "8"}});
    check(share(step), 3, 8);
}

TEST_CASE("arrays may begin anywhere, and their jobs may start tasks", "[unit]") {
    const Variables shifted = with(job_array, {{"SLURM_ARRAY_TASK_MIN", "1"}});
    check(share(shifted), 4, 10);
    const Variables apart{{"SLURM_ARRAY_TASK_ID", "13"},
                          {"SLURM_ARRAY_TASK_COUNT", "3"},
                          {"SLURM_ARRAY_TASK_MIN", "5"},
                          {"SLURM_ARRAY_TASK_STEP", "4"}};
    check(share(apart), 2, 3);
    check(share(with(job_array, srun)), 5 * 16 + 2, 160);
}

TEST_CASE("shares cover every case exactly once", "[unit]") {
    for (const int processes : {1, 2, 3, 7, 64})
        for (int index = 0; index < 50; ++index) {
            int owners = 0;
            for (int rank = 0; rank < processes; ++rank) owners += share({}, rank, processes).has(index) ? 1 : 0;
            CHECK(owners == 1);
        }
}

TEST_CASE("numbers that do not fit are refused by the name of who says them", "[unit]") {
    using Catch::Contains;
    CHECK_THROWS_WITH(share({}, 2, 2), Contains("--rank I --of N") && Contains("rank 2 of 2"));
    CHECK_THROWS_WITH(share({}, 2), Contains("--rank without --of"));
    CHECK_THROWS_WITH(share({}, {}, 2), Contains("--of without --rank"));
    CHECK_THROWS_WITH(share(with(srun, {{"SLURM_PROCID", "two"}})), Contains("SLURM_PROCID") && Contains("\"two\""));
    CHECK_THROWS_WITH(share(with(mpich, {{"PMI_RANK", "-1"}})), Contains("PMI_RANK"));
    CHECK_THROWS_WITH(share(with(mpich, {{"PMI_SIZE", "0"}})), Contains("PMI_RANK, PMI_SIZE"));
    CHECK_THROWS_WITH(share({{"SLURM_ARRAY_TASK_ID", "3"}}),
                      Contains("no environment variable SLURM_ARRAY_TASK_COUNT"));
    CHECK_THROWS_WITH(share(with(job_array, {{"SLURM_ARRAY_TASK_ID", "10"}})), Contains("an array without gaps"));
    CHECK_THROWS_WITH(share(with(job_array, {{"SLURM_ARRAY_TASK_MIN", "9"}})), Contains("an array without gaps"));
}

}  // namespace skerry::test::sweep_share_test
