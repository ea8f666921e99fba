/* Modified butterfly beside VTK's and OpenMesh's: one level, from indexed triangles to positions, everything that a
   program builds on the way inside the clock. Each time is that of a fresh process; the programs take turns, and the
   median counts. Then the positions are compared.
   usage: bench_peers [mesh file]... ; without one a geodesic sphere and an uneven mesh of this program's own */
#include "peer.h"

#include "pellicle/subdivide.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <string>

namespace
{

const int ROUNDS = 9;

soup soup_of(const pel_mesh *mesh)
{
    soup made;
    made.positions.assign(mesh->positions[0], mesh->positions[0] + 3 * (size_t)mesh->vertex_count);
    made.triangles.assign(mesh->triangles[0], mesh->triangles[0] + 3 * (size_t)mesh->triangle_count);
    return made;
}

double subdivide_pellicle(const soup &coarse, soup *fine)
{
    double start = pel_seconds();
    pel_mesh *mesh, *result;
    pel_error error;
    bench_check(pel_mesh_create(coarse.positions.data(), (int32_t)(coarse.positions.size() / 3),
                                coarse.triangles.data(), (int32_t)(coarse.triangles.size() / 3), &mesh, &error),
                &error);
    bench_check(pel_mesh_subdivide(mesh, 1, &result, &error), &error);
    double time = pel_seconds() - start;
    if (fine != nullptr)
        *fine = soup_of(result);
    pel_mesh_destroy(mesh);
    pel_mesh_destroy(result);
    return time;
}

struct peer {
    const char *name;
    double (*subdivide)(const soup &coarse, soup *fine);
};

const peer peers[] = {{"pellicle", subdivide_pellicle}, {"openmesh", subdivide_openmesh}, {"vtk", subdivide_vtk}};

soup take(pel_mesh *mesh)
{
    soup made = soup_of(mesh);
    pel_mesh_destroy(mesh);
    return made;
}

/* a sphere whose edges were turned at random and whose vertices were moved: valences 3 to 12, as after a scan */
soup uneven_mesh()
{
    soup mesh = take(bench_sphere(72));
    int triangle_count = (int)mesh.triangles.size() / 3;
    std::map<std::pair<int, int>, int> triangle_of; /* by directed edge */
    std::vector<int> valence(mesh.positions.size() / 3);
    auto corner = [&](int t, int i) -> int & { return mesh.triangles[(size_t)(3 * t + i % 3)]; };
    for (int t = 0; t < triangle_count; t++)
        for (int i = 0; i < 3; i++) {
            triangle_of[{corner(t, i), corner(t, i + 1)}] = t;
            valence[(size_t)corner(t, i)]++;
        }
    unsigned random = 1;
    for (int n = 0; n < triangle_count; n++) {
        random = random * 1664525u + 1013904223u;
        int t = (int)((random >> 8) % (unsigned)triangle_count), i = (int)((random >> 4) % 3);
        int a = corner(t, i), b = corner(t, i + 1), c = corner(t, i + 2), other = triangle_of[{b, a}];
        int k = corner(other, 0) == b ? 0 : corner(other, 1) == b ? 1 : 2, d = corner(other, k + 2);
        if (valence[(size_t)a] < 5 || valence[(size_t)b] < 5 ||
            triangle_of.count({c, d}) + triangle_of.count({d, c}) > 0)
            continue;
        triangle_of.erase({a, b});
        triangle_of.erase({b, a});
        const int first[3] = {a, d, c}, second[3] = {d, b, c};
        for (int j = 0; j < 3; j++) {
            corner(t, j) = first[j];
            corner(other, j) = second[j];
        }
        for (int j = 0; j < 3; j++) {
            triangle_of[{first[j], first[(j + 1) % 3]}] = t;
            triangle_of[{second[j], second[(j + 1) % 3]}] = other;
        }
        valence[(size_t)a]--;
        valence[(size_t)b]--;
        valence[(size_t)c]++;
        valence[(size_t)d]++;
    }
    for (double &x : mesh.positions) {
        random = random * 1664525u + 1013904223u;
        x *= 1 + 0.002 * ((double)(random >> 8) / (1 << 24) - 0.5);
    }
    return mesh;
}

soup load(const char *name)
{
    if (strcmp(name, "sphere") == 0)
        return take(bench_sphere(128));
    if (strcmp(name, "uneven") == 0)
        return uneven_mesh();
    return take(bench_read(name));
}

/* seconds of one fresh process */
double cold_time(const char *program, const char *mesh, const char *peer)
{
    double time = NAN;
    std::string command = std::string("'") + program + "' --one '" + mesh + "' " + peer;
    FILE *pipe = popen(command.c_str(), "r");
    if (pipe == nullptr || fscanf(pipe, "%lf", &time) != 1)
        fprintf(stderr, "%s: no time\n", peer);
    if (pipe != nullptr)
        pclose(pipe);
    return time;
}

typedef std::map<std::pair<int, int>, const double *> edge_points;

/* the new vertices by the edges they split */
edge_points points_of(const soup &fine, int coarse_count)
{
    std::vector<std::pair<int, int>> ends(fine.positions.size() / 3, {-1, -1});
    for (size_t t = 0; t < fine.triangles.size() / 3; t++)
        for (size_t i = 0; i < 3; i++) {
            int old = fine.triangles[3 * t + i];
            for (size_t k = 1; old < coarse_count && k < 3; k++) {
                int v = fine.triangles[3 * t + (i + k) % 3];
                std::pair<int, int> &e = ends[(size_t)v];
                if (v >= coarse_count && e.first != old && e.second != old)
                    (e.first < 0 ? e.first : e.second) = old;
            }
        }
    edge_points points;
    for (size_t v = (size_t)coarse_count; v < ends.size(); v++)
        points[{std::min(ends[v].first, ends[v].second), std::max(ends[v].first, ends[v].second)}] =
            &fine.positions[3 * v];
    return points;
}

/* largest difference over the box's longest side, and how many points are farther than float's rounding */
void compare(const soup &coarse, const soup &ours, const soup &theirs, const char *name)
{
    int count = (int)coarse.positions.size() / 3;
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, side = 0, most = 0;
    for (int v = 0; v < count; v++)
        for (int i = 0; i < 3; i++) {
            low[i] = std::min(low[i], coarse.positions[(size_t)(3 * v + i)]);
            high[i] = std::max(high[i], coarse.positions[(size_t)(3 * v + i)]);
        }
    for (int i = 0; i < 3; i++)
        side = std::max(side, high[i] - low[i]);
    edge_points p = points_of(ours, count), q = points_of(theirs, count);
    int missing = 0, far = 0;
    for (const auto &entry : p) {
        auto other = q.find(entry.first);
        missing += other == q.end();
        double distance = 0;
        for (int i = 0; other != q.end() && i < 3; i++)
            distance = std::max(distance, std::fabs(entry.second[i] - other->second[i]) / side);
        most = std::max(most, distance);
        far += distance > 1e-6;
    }
    printf("  %-9s largest difference %.2g of the box, %d of %d new vertices beyond 1e-6, %d missing\n", name, most,
           far, (int)p.size(), missing);
}

void bench(const char *program, const char *name)
{
    soup coarse = load(name), fine[3];
    printf("%s: %d triangles to %d\n", name, (int)coarse.triangles.size() / 3, 4 * (int)coarse.triangles.size() / 3);
    fflush(stdout);
    std::vector<double> times[3];
    for (int round = 0; round < ROUNDS; round++)
        for (int i = 0; i < 3; i++)
            times[i].push_back(cold_time(program, name, peers[i].name));
    for (int i = 0; i < 3; i++)
        std::sort(times[i].begin(), times[i].end());
    for (int i = 0; i < 3; i++)
        printf("  %-9s min %8.2f ms  median %8.2f ms  of %d   %5.1f times ours\n", peers[i].name, 1e3 * times[i][0],
               1e3 * times[i][ROUNDS / 2], ROUNDS, times[i][ROUNDS / 2] / times[0][ROUNDS / 2]);
    for (int i = 0; i < 3; i++)
        peers[i].subdivide(coarse, &fine[i]);
    compare(coarse, fine[0], fine[1], peers[1].name);
    compare(coarse, fine[0], fine[2], peers[2].name);
}

} // namespace

int main(int argc, char **argv)
{
    if (argc == 4 && strcmp(argv[1], "--one") == 0) {
        soup coarse = load(argv[2]);
        for (const peer &one : peers)
            if (strcmp(one.name, argv[3]) == 0)
                printf("%.9f\n", one.subdivide(coarse, nullptr));
        return 0;
    }
    if (argc == 1) {
        bench(argv[0], "sphere");
        bench(argv[0], "uneven");
    }
    for (int i = 1; i < argc; i++)
        bench(argv[0], argv[i]);
    return 0;
}
