// Runs the test cases of Ranks on MPI processes. It is started by mpirun. Arguments: the number of ranks, and `abort`
// if the last rank shall abort while the others wait for it.
#include <iostream>
#include <stdexcept>
#include <string>

#include "jobs/ranks/mpi_ranks.h"
#include "tests/ranks/ranks_cases.h"

int main(int argument_count, char* arguments[]) {
    const std::unique_ptr<skerry::Ranks> ranks = skerry::start_mpi();
    const std::string expected = argument_count > 1 ? arguments[1] : "";
    if (std::to_string(ranks->size()) != expected)
        ranks->abort("found " + std::to_string(ranks->size()) + " ranks, expected " + expected, 1);
    if (argument_count > 2) {
        if (ranks->rank() == ranks->size() - 1) ranks->abort("the last rank gives up", 1);
        ranks->gather_everywhere({});
    }
    for (const skerry::test::RanksCase& test : skerry::test::ranks_cases()) {
        try {
            test.run(*ranks);
        } catch (const std::exception& error) {
            ranks->abort(std::string(test.name) + ": " + error.what(), 1);
        }
    }
    if (ranks->rank() == 0) std::cout << skerry::test::ranks_cases().size() << " cases passed\n";
    return 0;
}
