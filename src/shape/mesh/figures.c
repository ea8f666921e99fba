#include "mesh/figures.h"

#include "base/memory.h"
#include "base/room.h"
#include "math/bounds.h"
#include "math/extremes.h"

#include <math.h>
#include <string.h>

static void fill_bounds(const pel_mesh *mesh, const uint8_t *not_finite, pel_mesh_report *report)
{
    bool first = true;
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        const double *p = mesh->positions[v];
        if (not_finite[v])
            continue;
        for (int i = 0; i < 3; i++) {
            report->bounds_low[i] = first ? p[i] : pel_min(report->bounds_low[i], p[i]);
            report->bounds_high[i] = first ? p[i] : pel_max(report->bounds_high[i], p[i]);
        }
        first = false;
    }
}

/* 4 sqrt(3) area / (sum of squared edges) */
static double shape_quality(const double a[3], const double b[3], const double c[3], double area)
{
    double ab = pel_vec3_distance(a, b), bc = pel_vec3_distance(b, c), ca = pel_vec3_distance(c, a);
    double squares = ab * ab + bc * bc + ca * ca;
    return squares > 0 ? 4 * sqrt(3.0) * area / squares : 0;
}

static void fill_triangle_figures(const pel_mesh *mesh, const uint8_t *not_finite, const int32_t *component_of_triangle,
                                  pel_mesh_report *report)
{
    int32_t count = 0;
    report->worst_triangle = -1;
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        const int32_t *v = mesh->triangles[t];
        if (component_of_triangle[t] < 0 || not_finite[v[0]] || not_finite[v[1]] || not_finite[v[2]])
            continue;
        pel_mesh_component *component = &report->components[component_of_triangle[t]];
        const double *a = mesh->positions[v[0]], *b = mesh->positions[v[1]], *c = mesh->positions[v[2]];
        double area = pel_vec3_triangle_area(a, b, c), quality = shape_quality(a, b, c, area);
        component->area += area;
        if (component->closed && component->oriented)
            component->volume +=
                pel_vec3_cone_volume(mesh->positions[mesh->triangles[component->first_triangle][0]], a, b, c);
        if (report->worst_triangle < 0 || quality < report->quality_min) {
            report->worst_triangle = t;
            report->quality_min = quality;
        }
        report->quality_mean += quality;
        count++;
    }
    if (count > 0)
        report->quality_mean /= count;
    for (int32_t c = 0; c < report->component_count; c++) {
        report->area += report->components[c].area;
        report->volume += report->components[c].volume;
    }
}

/* the number of that rank (0 = smallest) among non-negative ones: their bits have the same order, so the answer is
   built from the top by counting, 16 bits at a time */
static double select_rank(const double *values, int32_t count, int32_t rank, uint32_t *tally)
{
    uint64_t prefix = 0;
    for (int shift = 48; shift >= 0; shift -= 16) {
        memset(tally, 0, 65536 * sizeof *tally);
        for (int32_t i = 0; i < count; i++) {
            uint64_t bits;
            memcpy(&bits, &values[i], sizeof bits);
            if (shift == 48 || bits >> (shift + 16) == prefix)
                tally[(bits >> shift) & 0xffff]++;
        }
        uint64_t digit = 0;
        for (; (uint32_t)rank >= tally[digit]; digit++)
            rank -= (int32_t)tally[digit];
        prefix = prefix << 16 | digit;
    }
    double value;
    memcpy(&value, &prefix, sizeof value);
    return value;
}

/* lengths (edge_count) of the edges with finite ends; returns how many */
static int32_t measure_edges(const pel_mesh *mesh, const uint8_t *not_finite, const pel_edge_table *edges,
                             double *lengths)
{
    int32_t count = 0;
    for (int32_t e = 0; e < edges->edge_count; e++) {
        int32_t h = edges->half_edge_of_edge[e];
        int32_t a = mesh->triangles[h / 3][h % 3], b = mesh->triangles[h / 3][(h + 1) % 3];
        if (!not_finite[a] && !not_finite[b])
            lengths[count++] = pel_vec3_distance(mesh->positions[a], mesh->positions[b]);
    }
    return count;
}

static void fill_edge_figures(const double *lengths, int32_t count, uint32_t *tally, pel_mesh_report *report)
{
    if (count == 0)
        return;
    double sum = 0, shortest = lengths[0], longest = lengths[0];
    for (int32_t i = 0; i < count; i++) {
        sum += lengths[i];
        shortest = pel_min(shortest, lengths[i]);
        longest = pel_max(longest, lengths[i]);
    }
    report->edge_length_min = shortest;
    report->edge_length_max = longest;
    report->edge_length_mean = sum / count;
    report->edge_length_median =
        (select_rank(lengths, count, (count - 1) / 2, tally) + select_rank(lengths, count, count / 2, tally)) / 2;
}

static void fill_valences(const pel_mesh *mesh, const pel_edge_table *edges, int32_t *valence, pel_mesh_report *report)
{
    int32_t used_count = 0;
    for (int32_t e = 0; e < edges->edge_count; e++) {
        int32_t h = edges->half_edge_of_edge[e];
        valence[mesh->triangles[h / 3][h % 3]]++;
        valence[mesh->triangles[h / 3][(h + 1) % 3]]++;
    }
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        if (valence[v] == 0)
            continue;
        if (used_count == 0 || valence[v] < report->valence_min)
            report->valence_min = valence[v];
        if (valence[v] > report->valence_max)
            report->valence_max = valence[v];
        used_count++;
    }
    if (used_count > 0)
        report->valence_mean = 2.0 * edges->edge_count / used_count;
}

pel_status pel_figures_fill(const pel_mesh *mesh, const uint8_t *not_finite, const int32_t *component_of_triangle,
                            const pel_edge_table *edges, pel_mesh_report *report)
{
    double *lengths = pel_allocate((size_t)edges->edge_count, sizeof *lengths);
    uint32_t *tally = pel_allocate(65536, sizeof *tally);
    int32_t *valence = pel_allocate((size_t)mesh->vertex_count, sizeof *valence);
    bool made = lengths != NULL && tally != NULL && valence != NULL;
    if (made) {
        fill_bounds(mesh, not_finite, report);
        fill_triangle_figures(mesh, not_finite, component_of_triangle, report);
        int32_t count = measure_edges(mesh, not_finite, edges, lengths);
        fill_edge_figures(lengths, count, tally, report);
        fill_valences(mesh, edges, valence, report);
    }
    PEL_FREE_ALL(valence, tally, lengths);
    return made ? PEL_OK : PEL_OUT_OF_MEMORY;
}

void pel_mesh_add_box(const pel_mesh *mesh, double low[3], double high[3])
{
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        pel_bounds_add(low, high, mesh->positions[v]);
}

void pel_mesh_box(const pel_mesh *mesh, double low[3], double high[3])
{
    pel_bounds_clear(low, high);
    if (mesh != NULL)
        pel_mesh_add_box(mesh, low, high);
}

double pel_mesh_diagonal(const pel_mesh *mesh)
{
    double low[3], high[3];
    pel_mesh_box(mesh, low, high);
    return pel_vec3_distance(low, high);
}
