#include <pellicle/pellicle.h>

#include <cstdio>
#include <vector>

int main()
{
    const std::vector<double> positions = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const std::vector<int32_t> triangles = {0, 1, 2};
    pel_mesh *mesh = nullptr;
    pel_error error;
    if (pel_mesh_create(positions.data(), 3, triangles.data(), 1, &mesh, &error) != PEL_OK)
        return 1;
    std::printf("%d triangle\n", static_cast<int>(mesh->triangle_count));
    pel_mesh_destroy(mesh);
    return 0;
}
