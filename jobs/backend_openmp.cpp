// OpenMP backend. Each outermost call starts one team of threads; calls from inside the team add tasks to this team.
#include <omp.h>

#include <algorithm>

#include "jobs/backends.h"

namespace skerry {

namespace {

class OpenMpExecutor;

// The executor in whose team this thread works now, or null. omp_in_parallel() cannot replace this pointer, because it
// is also true in a team of the host program.
thread_local const OpenMpExecutor* team_of_thread = nullptr;

class TeamScope {
public:
    explicit TeamScope(const OpenMpExecutor* executor) : outer_(team_of_thread) { team_of_thread = executor; }
    ~TeamScope() { team_of_thread = outer_; }
    TeamScope(const TeamScope&) = delete;
    TeamScope& operator=(const TeamScope&) = delete;

private:
    const OpenMpExecutor* outer_;
};

class OpenMpExecutor final : public Executor {
public:
    explicit OpenMpExecutor(int workers) : workers_(workers > 0 ? workers : omp_get_max_threads()) {}

    Backend backend() const override { return Backend::openmp; }
    int worker_count() const override { return workers_; }

    void run_blocks(Index count, FunctionRef<void(Index)> body) override {
        BlockJob job(count, body, workers_);
        if (count <= 1 || workers_ == 1) {
            job.drain(0);
        } else if (team_of_thread == this) {
            drain_in_team(job, std::min(count, workers_) - 1);
        } else {
            // The complete team is used even if there are fewer blocks than workers. For a smaller team the OpenMP
            // runtime would end the surplus threads and create them again for the next call.
#pragma omp parallel num_threads(workers_)
            {
                const TeamScope scope(this);
                job.drain(omp_get_thread_num());
            }
        }
        job.rethrow();
    }

    void run_graph(const GraphEdges& edges, FunctionRef<void(Index)> run_stage) override {
        GraphJob job(edges, run_stage, left_);
        if (workers_ == 1) {
            job.run_all();
        } else {
#pragma omp parallel num_threads(workers_)
            {
                const TeamScope scope(this);
#pragma omp single
                {
                    const Spawner spawn{job};
                    job.run_from(job.spawn_roots(spawn), spawn);
                }
            }
        }
        job.rethrow();
    }

private:
    static void drain_in_team(BlockJob& job, int helpers) {
#pragma omp taskgroup
        {
            for (int i = 0; i < helpers; ++i) {
#pragma omp task shared(job)
                job.drain(omp_get_thread_num());
            }
            job.drain(omp_get_thread_num());
        }
    }

    struct Spawner {
        GraphJob& job;

        void operator()(Index stage) const {
            GraphJob* const target = &job;
#pragma omp task firstprivate(target, stage)
            target->run_from(stage, Spawner{*target});
        }
    };

    int workers_;
    PredecessorCounts left_;
};

}  // namespace

std::unique_ptr<Executor> make_openmp_executor(int workers) {
    return std::make_unique<OpenMpExecutor>(workers);
}

}  // namespace skerry
