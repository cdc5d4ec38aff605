// Divides a world among the processes of an MPI program.
#include <mpi.h>
#include <skerry/mesh.h>
#include <skerry/mpi.h>

namespace {

skerry::World falling_balls() {
    skerry::World world({.threads = 1});
    const auto rubber = world.add_material({.young_modulus = 1e5});
    for (int i = 0; i < 4; ++i)
        world.add_body(skerry::mesh::ball(0.1, 2), {.material = rubber, .position = {0, 0, 0.2 + 0.25 * i}});
    world.add_collider(skerry::Plane{});
    return world;
}

bool is_same_as_alone() {
    const std::shared_ptr<skerry::Ranks> ranks = skerry::mpi_ranks(MPI_Comm_c2f(MPI_COMM_WORLD));
    skerry::World alone = falling_balls(), shared = falling_balls();
    skerry::distribute(shared, *ranks);
    if (!alone.advance(0.1).ok() || !shared.advance(0.1).ok()) return false;
    const std::optional<skerry::World> whole = skerry::gathered(shared);
    return !whole || whole->state_hash() == alone.state_hash();
}

}  // namespace

int main(int argument_count, char** arguments) {
    int level = 0;
    MPI_Init_thread(&argument_count, &arguments, MPI_THREAD_SERIALIZED, &level);
    const bool same = is_same_as_alone();
    MPI_Finalize();
    return same ? 0 : 1;
}
