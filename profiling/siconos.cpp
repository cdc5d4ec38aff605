#include "profiling/siconos.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <siconos/numerics/FrictionContactProblem.h>
#include <siconos/numerics/Friction_cst.h>
#include <siconos/numerics/NonSmoothDrivers.h>
#include <siconos/numerics/NumericsMatrix.h>
#include <siconos/numerics/NumericsVerbose.h>
#include <siconos/numerics/SolverOptions.h>
#include <siconos/numerics/SparseBlockMatrix.h>
#include <siconos/numerics/sn_error_handling.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "profiling/measure.h"

namespace skerry::profiling {
namespace {

enum class Storage { blocks, sparse, dense };

/// A solver, and its options that differ from the defaults.
struct Choice {
    const char* name;
    int solver;
    Storage storage = Storage::blocks;
    int local_solver = 0;  // local solver of Gauss-Seidel; 0: the default, a Newton method after a projection
    // Number of sweeps between measurements of the full error; 0: the default, the change of a sweep and a full test at
    // the end.
    int full_error = 0;
    double relaxation = 0;  // relaxation factor of Gauss-Seidel (PSOR)
    int freezing = 0;       // sweeps for which contacts at rest are left out
    int hybrid = -1;        // hybrid strategy of the nonsmooth Newton method
    int balancing = -1;     // penalty strategy of ADMM (augmented Lagrangian)
    int symmetry = -1;      // symmetry option of ADMM (augmented Lagrangian)
    Index most_contacts = 1 << 30;
    Index first_iterations = 20;
};

constexpr int gauss_seidel = SICONOS_FRICTION_3D_NSGS;
constexpr int quartic = SICONOS_FRICTION_3D_ONECONTACT_QUARTIC, newton = SICONOS_FRICTION_3D_ONECONTACT_NSN;
constexpr int damped = SICONOS_FRICTION_3D_ONECONTACT_NSN_GP, hybrid = SICONOS_FRICTION_3D_ONECONTACT_NSN_GP_HYBRID;

constexpr Choice choices[] = {
    {.name = "nsgs", .solver = gauss_seidel},
    {.name = "nsgs_quartic_full1", .solver = gauss_seidel, .local_solver = quartic, .full_error = 1},
    {.name = "nsgs_quartic_full5", .solver = gauss_seidel, .local_solver = quartic, .full_error = 5},
    {.name = "nsgs_nsn_full1", .solver = gauss_seidel, .local_solver = newton, .full_error = 1},
    {.name = "nsgs_nsn_full5", .solver = gauss_seidel, .local_solver = newton, .full_error = 5},
    {.name = "nsgs_nsngp_full1", .solver = gauss_seidel, .local_solver = damped, .full_error = 1},
    {.name = "nsgs_nsngp_full5", .solver = gauss_seidel, .local_solver = damped, .full_error = 5},
    {.name = "nsgs_hybrid_full1", .solver = gauss_seidel, .local_solver = hybrid, .full_error = 1},
    {.name = "nsgs_hybrid_full5", .solver = gauss_seidel, .local_solver = hybrid, .full_error = 5},
    {.name = "nsgs_freeze", .solver = gauss_seidel, .local_solver = damped, .freezing = 10},
    {.name = "psor_1.4_nsngp_full5",
     .solver = gauss_seidel,
     .local_solver = damped,
     .full_error = 5,
     .relaxation = 1.4},
    {.name = "nsn_ac_dense",
     .solver = SICONOS_FRICTION_3D_NSN_AC,
     .storage = Storage::dense,
     .hybrid = 0,
     .most_contacts = 150,
     .first_iterations = 4},
    {.name = "nsn_ac_sparse",
     .solver = SICONOS_FRICTION_3D_NSN_AC,
     .storage = Storage::sparse,
     .hybrid = 0,
     .most_contacts = 1500,
     .first_iterations = 4},
    {.name = "nsn_ac_hybrid",
     .solver = SICONOS_FRICTION_3D_NSN_AC,
     .storage = Storage::sparse,
     .hybrid = SICONOS_FRICTION_3D_NSN_HYBRID_STRATEGY_VI_EG_NSN,
     .most_contacts = 1500,
     .first_iterations = 4},
    {.name = "admm",
     .solver = SICONOS_FRICTION_3D_ADMM,
     .storage = Storage::sparse,
     .balancing = SICONOS_FRICTION_3D_ADMM_RHO_STRATEGY_RESIDUAL_BALANCING,
     .most_contacts = 3000},
    {.name = "admm_constant",
     .solver = SICONOS_FRICTION_3D_ADMM,
     .storage = Storage::sparse,
     .balancing = SICONOS_FRICTION_3D_ADMM_RHO_STRATEGY_CONSTANT,
     .symmetry = SICONOS_FRICTION_3D_ADMM_ASSUME_SYMMETRY,
     .most_contacts = 3000},
    {.name = "prox", .solver = SICONOS_FRICTION_3D_PROX, .most_contacts = 3000, .first_iterations = 2},
};

SolverOptions* make_options(const Choice& choice, Real tolerance, Index max_iterations) {
    SolverOptions* options = solver_options_create(choice.solver);
    options->dparam[SICONOS_DPARAM_TOL] = tolerance;
    options->iparam[SICONOS_IPARAM_MAX_ITER] = max_iterations;
    if (choice.local_solver != 0) solver_options_update_internal(options, 0, choice.local_solver);
    if (choice.full_error != 0) {
        options->iparam[SICONOS_FRICTION_3D_IPARAM_ERROR_EVALUATION] = SICONOS_FRICTION_3D_NSGS_ERROR_EVALUATION_FULL;
        options->iparam[SICONOS_FRICTION_3D_IPARAM_ERROR_EVALUATION_FREQUENCY] = choice.full_error;
    }
    if (choice.relaxation != 0) {
        options->iparam[SICONOS_FRICTION_3D_NSGS_RELAXATION] = SICONOS_FRICTION_3D_NSGS_RELAXATION_TRUE;
        options->dparam[SICONOS_FRICTION_3D_NSGS_RELAXATION_VALUE] = choice.relaxation;
    }
    if (choice.freezing != 0) options->iparam[SICONOS_FRICTION_3D_NSGS_FREEZING_CONTACT] = choice.freezing;
    if (choice.hybrid >= 0) options->iparam[SICONOS_FRICTION_3D_NSN_HYBRID_STRATEGY] = choice.hybrid;
    if (choice.symmetry >= 0) options->iparam[SICONOS_FRICTION_3D_ADMM_IPARAM_SYMMETRY] = choice.symmetry;
    if (choice.balancing >= 0) options->iparam[SICONOS_FRICTION_3D_ADMM_IPARAM_RHO_STRATEGY] = choice.balancing;
    return options;
}

/// Discards all output: some of Siconos' solvers print at any verbosity.
class Silence {
public:
    Silence() {
        std::fflush(nullptr);
        const int nowhere = open("/dev/null", O_WRONLY);
        for (int file = 1; file <= 2; ++file) dup2(nowhere, file);
        close(nowhere);
    }
    ~Silence() {
        std::fflush(nullptr);
        for (int file = 1; file <= 2; ++file) {
            dup2(kept_[file - 1], file);
            close(kept_[file - 1]);
        }
    }
    Silence(const Silence&) = delete;
    Silence& operator=(const Silence&) = delete;

private:
    int kept_[2] = {dup(1), dup(2)};
};

/// Siconos leaves a failed call by a long jump, so nothing with a destructor may live in here. Returns -1 in that case.
[[gnu::noinline]] int call_driver(FrictionContactProblem* problem, double* reaction, double* velocity,
                                  SolverOptions* options) {
    if (SN_SETJMP_EXTERNAL_START != 0) return -1;
    const int status = fc3d_driver(problem, reaction, velocity, options);
    SN_SETJMP_EXTERNAL_STOP
    return status;
}

}  // namespace

struct SiconosProblem::Data {
    explicit Data(const ContactProblem& source)
        : problem(source), q(3 * problem.q.size()), mu(problem.mu), block(problem.block) {
        for (std::size_t i = 0; i < problem.q.size(); ++i) std::copy_n(problem.q[i].data(), 3, q.data() + 3 * i);
        reaction.resize(q.size());
        velocity.resize(q.size());
    }
    ~Data() {
        for (NumericsMatrix* matrix : {sparse, dense})
            if (matrix != nullptr) NM_free(matrix);
    }

    NumericsMatrix* matrix(Storage kind) {
        switch (kind) {
            case Storage::sparse:
                if (sparse == nullptr) fill(sparse, NM_SPARSE);
                return sparse;
            case Storage::dense:
                if (dense == nullptr) fill(dense, NM_DENSE);
                return dense;
            case Storage::blocks:
                break;
        }
        if (block_pointer.empty()) fill_blocks();
        return &blocks;
    }

    /// Fills the block matrix with copies: Siconos does not write into the blocks, but its types are not const.
    void fill_blocks() {
        const std::size_t contacts = problem.q.size();
        for (Mat3& b : block) block_pointer.push_back(b.data());
        for (std::size_t i = 0; i < contacts; ++i) size.push_back(static_cast<unsigned>(3 * (i + 1)));
        row_begin.assign(problem.row_offset.begin(), problem.row_offset.end());
        column.assign(problem.column.begin(), problem.column.end());
        SBM_null(&storage);
        storage.nbblocks = static_cast<unsigned>(block.size());
        storage.block = block_pointer.data();
        storage.blocknumber0 = storage.blocknumber1 = static_cast<unsigned>(contacts);
        storage.blocksize0 = storage.blocksize1 = size.data();
        storage.filled1 = contacts + 1;
        storage.filled2 = block.size();
        storage.index1_data = row_begin.data();
        storage.index2_data = column.data();
        NM_null(&blocks);
        NM_fill(&blocks, NM_SPARSE_BLOCK, static_cast<int>(q.size()), static_cast<int>(q.size()), &storage);
    }

    void fill(NumericsMatrix*& matrix, NM_types type) {
        const int rows = static_cast<int>(q.size());
        matrix = NM_create(type, rows, rows);
        if (type == NM_SPARSE) NM_triplet_alloc(matrix, static_cast<CS_INT>(9 * block.size()));
        for (int i = 0; i < rows / 3; ++i)
            for (Index k = problem.row_offset[i]; k < problem.row_offset[i + 1]; ++k)
                for (int a = 0; a < 3; ++a)
                    for (int b = 0; b < 3; ++b) NM_entry(matrix, 3 * i + a, 3 * problem.column[k] + b, block[k](a, b));
    }

    const ContactProblem& problem;
    std::vector<double> q, mu, reaction, velocity;
    std::vector<Mat3> block;
    std::vector<double*> block_pointer;
    std::vector<unsigned> size;
    std::vector<size_t> row_begin, column;
    SparseBlockStructuredMatrix storage{};
    NumericsMatrix blocks{};
    NumericsMatrix* sparse = nullptr;
    NumericsMatrix* dense = nullptr;
};

SiconosProblem::SiconosProblem(const ContactProblem& problem) : data_(std::make_unique<Data>(problem)) {
    numerics_set_verbose(0);
    // Siconos uses one thread, like Skerry. It is linked to the BLAS that the system chose.
    using SetThreads = void (*)(int);
    if (const auto set_threads = reinterpret_cast<SetThreads>(dlsym(RTLD_DEFAULT, "openblas_set_num_threads")))
        set_threads(1);
}
SiconosProblem::~SiconosProblem() = default;

SiconosSolution SiconosProblem::solve(std::size_t variant, Real tolerance, Index max_iterations) {
    const Choice& choice = choices[variant];
    FrictionContactProblem problem{};
    problem.dimension = 3;
    problem.numberOfContacts = data_->problem.contacts();
    problem.M = data_->matrix(choice.storage);
    problem.q = data_->q.data();
    problem.mu = data_->mu.data();

    SolverOptions* options = nullptr;
    int status = 0;
    SiconosSolution solution;
    const Silence silence;
    solution.seconds = timed(
        [&] {
            if (options != nullptr) solver_options_delete(options);
            options = make_options(choice, tolerance, max_iterations);
            std::ranges::fill(data_->reaction, 0);
            std::ranges::fill(data_->velocity, 0);
        },
        [&] { status = call_driver(&problem, data_->reaction.data(), data_->velocity.data(), options); });
    solution.iterations = options->iparam[SICONOS_IPARAM_ITER_DONE];
    solver_options_delete(options);
    solution.finished = status == 0;
    for (std::size_t i = 0; i < data_->reaction.size(); i += 3)
        solution.reaction.emplace_back(data_->reaction[i], data_->reaction[i + 1], data_->reaction[i + 2]);
    return solution;
}

const std::vector<SiconosVariant>& siconos_variants() {
    static const std::vector<SiconosVariant> variants = [] {
        std::vector<SiconosVariant> all;
        for (const Choice& choice : choices)
            all.push_back({choice.name, choice.most_contacts, choice.first_iterations});
        return all;
    }();
    return variants;
}

}  // namespace skerry::profiling
