#include "peer.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Subdivider/Uniform/ModifiedButterFlyT.hh>

namespace
{
struct traits : public OpenMesh::DefaultTraits {
    typedef OpenMesh::Vec3d Point;
    typedef OpenMesh::Vec3d Normal;
};
typedef OpenMesh::TriMesh_ArrayKernelT<traits> mesh_type;
} // namespace

double subdivide_openmesh(const soup &coarse, soup *fine)
{
    double start = pel_seconds();
    mesh_type mesh;
    size_t vertex_count = coarse.positions.size() / 3, triangle_count = coarse.triangles.size() / 3;
    mesh.reserve(vertex_count, 3 * triangle_count / 2, triangle_count);
    std::vector<mesh_type::VertexHandle> handles(vertex_count);
    for (size_t v = 0; v < vertex_count; v++)
        handles[v] = mesh.add_vertex(
            mesh_type::Point(coarse.positions[3 * v], coarse.positions[3 * v + 1], coarse.positions[3 * v + 2]));
    for (size_t t = 0; t < triangle_count; t++)
        mesh.add_face(handles[(size_t)coarse.triangles[3 * t]], handles[(size_t)coarse.triangles[3 * t + 1]],
                      handles[(size_t)coarse.triangles[3 * t + 2]]);
    OpenMesh::Subdivider::Uniform::ModifiedButterflyT<mesh_type, double> butterfly;
    butterfly.attach(mesh);
    butterfly(1);
    butterfly.detach();
    double time = pel_seconds() - start;
    if (fine == nullptr)
        return time;
    for (auto v : mesh.vertices())
        for (int i = 0; i < 3; i++)
            fine->positions.push_back(mesh.point(v)[(size_t)i]);
    for (auto f : mesh.faces())
        for (auto v : mesh.fv_range(f))
            fine->triangles.push_back(v.idx());
    return time;
}
