/* Figures 16 to 20 of paper B, the weight of bending and the energies of fibres, and table 2, collision detection. */
#include "papers/b/shrink.h"

#include <pellicle/geometry.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- figures 16 to 18 ---- */

enum { WEIGHTS = 6, W_1 = 0, W_01 = 1, W_001 = 2, W_0001 = 3, W_0 = 4, W_AUTO = 5 };

static const char *const weights[WEIGHTS] = {"1", "0.1", "0.01", "0.001", "0", "auto"};

typedef struct weighed {
    char names[WEIGHTS][64];
    double volumes[WEIGHTS]; /* in frame 100 */
    int rises[WEIGHTS];      /* of the volume until then */
    int turns[WEIGHTS];      /* between falling and rising */
    b_shrunk shapes[WEIGHTS];
    double further; /* volume with auto over that with 0.01, while both shrink */
    b_contacts contacts;
} weighed;

static pel_status weigh(lab_experiment *experiment, int body, weighed *made)
{
    pel_status status = PEL_OK;
    for (int i = 0; status == PEL_OK && i < WEIGHTS; i++) {
        char weight[64];
        pel_run_summary summary = {0};
        snprintf(weight, sizeof weight, "bodies.0.bending.weight=%s", weights[i]);
        const char *settings[] = {weight, NULL};
        status = b_shrink(experiment, body, weights[i], settings, &summary);
        b_run_name(experiment, body, weights[i], made->names[i]);
        if (status == PEL_OK)
            status = b_volume(experiment, made->names[i], 100, &made->volumes[i], &made->rises[i]);
        if (status == PEL_OK)
            status = b_turns(experiment, made->names[i], 100, &made->turns[i]);
        if (status == PEL_OK)
            status = b_measure(experiment, body, made->names[i], 50, &made->shapes[i]);
        if (status == PEL_OK)
            status = b_add_contacts(experiment, body, weights[i], &summary, &made->contacts);
    }
    if (status == PEL_OK)
        status = b_volume_ratio(experiment, made->names[W_AUTO], made->names[W_001], 100, &made->further);
    return status;
}

static void judge_weights(lab_experiment *experiment, const weighed *made)
{
    int count = experiment->body_count;
    lab_begin_claim(experiment, LAB_PAPER, "with k_B 1 and 0.1 the volume changes little in 100 frames",
                    "the paper does not give its pressure: k_B 0.1 leaves 0.80 of the liver; under two thirds of the "
                    "pressure 0.90, and k_B 0.01 still shrinks it to 0.74");
    for (int body = 0; body < count; body++)
        for (int i = 0; i < 2; i++) {
            char text[48];
            snprintf(text, sizeof text, "volume in frame 100, k_B %s", weights[i]);
            b_expect(experiment, body, text, made[body].volumes[i], 1, 0.15, B_PAPER ", figure 17; 0.15 is ours");
        }
    lab_begin_claim(experiment, LAB_PAPER, "with k_B 1 the volume oscillates", NULL);
    for (int body = 0; body < count; body++)
        b_at_least(experiment, body, "turns of the volume in 100 frames, k_B 1", made[body].turns[W_1], 3,
                   B_PAPER ", figure 18; 3 is ours");
    lab_begin_claim(
        experiment, LAB_PAPER, "with k_B 0.01 the volume decreases clearly and monotonically",
        "rises of at most 6e-4 of the volume in a frame, where thin limbs resist or both sides of a hollow wall touch");
    for (int body = 0; body < count; body++) {
        b_at_most(experiment, body, "volume in frame 100, k_B 0.01", made[body].volumes[W_001], 0.85,
                  B_PAPER ", figure 18; 0.85 is ours");
        b_at_most(experiment, body, "rises in 100 frames, k_B 0.01", made[body].rises[W_001], 0, B_PAPER ", figure 18");
    }
    lab_begin_claim(experiment, LAB_PAPER, "with k_B 0.001 the volume is near that without bending energy", NULL);
    for (int body = 0; body < count; body++)
        b_expect(experiment, body, "volume, k_B 0.001 minus k_B 0",
                 made[body].volumes[W_0001] - made[body].volumes[W_0], 0, 0.1, B_PAPER ", figure 17; 0.1 is ours");
    lab_begin_claim(experiment, LAB_PAPER, "k_B 0.001 and 0 are rougher than 0.01", NULL);
    for (int body = 0; body < count; body++)
        for (int i = W_0001; i <= W_0; i++) {
            char text[48];
            snprintf(text, sizeof text, "roughness in frame 50, k_B 0.01 / %s", weights[i]);
            b_at_most(experiment, body, text, made[body].shapes[W_001].roughness / made[body].shapes[i].roughness, 0.95,
                      B_PAPER ", figure 16; 0.95 is ours");
        }
    lab_begin_claim(experiment, LAB_PAPER,
                    "future work of section 7: an automatic k_B shrinks bodies further, without jitter", NULL);
    for (int body = 0; body < count; body++) {
        b_at_most(experiment, body, "volume in frame 100, auto / k_B 0.01", made[body].further, 0.97,
                  B_PAPER ", section 7");
        b_at_most(experiment, body, "rises, auto minus those of 0.01",
                  made[body].rises[W_AUTO] - made[body].rises[W_001], 0, B_PAPER ", section 7");
    }
    b_begin_contact_claim(experiment, NULL);
    for (int body = 0; body < count; body++)
        b_judge_contacts(experiment, body, "all six", &made[body].contacts);
}

/* figure 17: all weights on one body; figure 18: all bodies with two of them */
static pel_status plot_weights(lab_experiment *experiment, const weighed *made)
{
    static const int shown[2] = {W_1, W_001};
    const char *runs[LAB_CURVES], *labels[LAB_CURVES];
    char texts[LAB_CURVES][80];
    int count = 0;
    for (int i = 0; i < LAB_CURVES; i++)
        labels[i] = texts[i];
    for (int i = 0; i < WEIGHTS; i++) {
        runs[i] = made[0].names[i];
        snprintf(texts[i], sizeof *texts, "k_B %s", weights[i]);
    }
    pel_status status = b_plot_volumes(experiment, "figure 17: volume with different k_B", runs, labels, WEIGHTS);
    for (int body = 0; body < experiment->body_count; body++)
        for (int i = 0; i < 2 && count < LAB_CURVES; i++) {
            runs[count] = made[body].names[shown[i]];
            snprintf(texts[count++], sizeof *texts, "%s, k_B %s", experiment->bodies[body].name, weights[shown[i]]);
        }
    return status == PEL_OK
               ? b_plot_volumes(experiment, "figure 18: volume of bodies with k_B 1 and 0.01", runs, labels, count)
               : status;
}

static pel_status run_figure_16_18(lab_experiment *experiment)
{
    static weighed made[LAB_BODIES];
    pel_status status = PEL_OK;
    memset(made, 0, sizeof made);
    for (int body = 0; status == PEL_OK && body < experiment->body_count; body++)
        status = weigh(experiment, body, &made[body]);
    if (status != PEL_OK)
        return status;
    judge_weights(experiment, made);
    status = plot_weights(experiment, made);
    lab_picture picture = {.caption = "figure 16: k_B 1, 0.1, 0.01, 0.001, 0 and auto in frames 50 and 100",
                           .run_count = WEIGHTS,
                           .frames = {50, 100},
                           .frame_count = 2,
                           .columns = 4,
                           .field = "none",
                           .azimuth = 35,
                           .elevation = 20};
    for (int i = 0; i < WEIGHTS; i++) {
        static const char *const labels[WEIGHTS] = {"k_B 1", "0.1", "0.01", "0.001", "0", "auto"};
        picture.runs[i] = made[0].names[i];
        picture.labels[i] = labels[i];
    }
    return status == PEL_OK ? lab_add_picture(experiment, &picture) : status;
}

const lab_case b_figure_16_18 = {
    .name = "b-figure16-18",
    .doc = "the bending weight k_B, fixed and automatic",
    .group = "paper B",
    .place = "section 6.3, figures 16 to 18",
    .run = run_figure_16_18,
};

/* ---- figures 19 and 20 ---- */

/* none, and the three energies */
enum { FIBRES = 4 };
static const char *const fibres[FIBRES] = {"none", "arap", "sqrt", "stvk"};

typedef struct caved {
    char names[FIBRES][64];
    double volumes[FIBRES]; /* in frame 100 */
    b_shrunk shapes[FIBRES];
    double areas[FIBRES];   /* over that at rest, in the last frame */
    double limited[FIBRES]; /* mean share of the corrections of E_A that their bound cut */
    double further;         /* volume with arap over that with none, while both shrink */
    b_contacts contacts;
} caved;

static pel_status run_fibres(lab_experiment *experiment, int body, caved *made)
{
    pel_status status = PEL_OK;
    for (int i = 0; status == PEL_OK && i < FIBRES; i++) {
        char energy[B_FIBRES_SIZE];
        int rises;
        pel_run_summary summary = {0};
        const char *settings[] = {i > 0 ? b_fibres(experiment, body, fibres[i], energy) : NULL,
                                  experiment->bodies[body].cap, NULL};
        status = b_shrink(experiment, body, fibres[i], settings, &summary);
        b_run_name(experiment, body, fibres[i], made->names[i]);
        if (status == PEL_OK)
            status = b_volume(experiment, made->names[i], 100, &made->volumes[i], &rises);
        if (status == PEL_OK)
            status = b_measure(experiment, body, made->names[i], 100, &made->shapes[i]);
        if (status == PEL_OK)
            status = b_last(experiment, made->names[i], "area_ratio", &made->areas[i]);
        if (status == PEL_OK && i > 0)
            status = b_mean(experiment, made->names[i], "caving_limited", &made->limited[i]);
        if (status == PEL_OK)
            status = b_add_contacts(experiment, body, fibres[i], &summary, &made->contacts);
    }
    if (status == PEL_OK)
        status = b_volume_ratio(experiment, made->names[1], made->names[0], 100, &made->further);
    return status;
}

static void judge_fibres(lab_experiment *experiment, const caved *made)
{
    lab_begin_claim(experiment, LAB_PAPER, "all three energies make the region cave in", NULL);
    for (int body = 0; body < experiment->body_count; body++)
        for (int i = 1; i < FIBRES; i++) {
            char text[56];
            snprintf(text, sizeof text, "depth of the cap, %s, minus that without fibres [m]", fibres[i]);
            b_at_least(experiment, body, text, made[body].shapes[i].cap_depth - made[body].shapes[0].cap_depth, 0.02,
                       B_PAPER ", figure 19; 0.02 is ours");
        }
    lab_begin_claim(experiment, LAB_PAPER, "with fibres the volume decreases faster and ends smaller",
                    "the cap caves in, but its share of the volume is small, and where it holds the wall behind it "
                    "the rest falls together more slowly");
    for (int body = 0; body < experiment->body_count; body++)
        b_at_most(experiment, body, "volume in frame 100, arap / none", made[body].further, 0.99,
                  B_PAPER ", figure 20");
    lab_begin_claim(experiment, LAB_THEORY, "on a surface arap and sqrt are one energy", NULL);
    lab_by_construction(experiment, "both are one line of the program, because I4 > 0");
    for (int body = 0; body < experiment->body_count; body++)
        b_expect(experiment, body, "volume, arap minus sqrt", made[body].volumes[1] - made[body].volumes[2], 0, 1e-9,
                 "theory.md, section 4: I4 > 0");
    lab_begin_claim(experiment, LAB_THEORY,
                    "stvk, with as much push at small strains, falls behind arap as its energy of large ones does",
                    NULL);
    for (int body = 0; body < experiment->body_count; body++)
        b_expect(experiment, body, "depth of the cap, stvk / arap",
                 made[body].shapes[3].cap_depth / made[body].shapes[1].cap_depth, 0.95, 0.049,
                 "theory.md, section 4: (1 - e / 2)^2 at the shortening e");
    lab_begin_claim(experiment, LAB_THEORY, "E_A decides the depth, not the bound of a correction; the area stays",
                    NULL);
    for (int body = 0; body < experiment->body_count; body++)
        for (int i = 1; i < FIBRES; i += 2) {
            char text[56];
            snprintf(text, sizeof text, "%s, share of corrections that are cut", fibres[i]);
            b_at_most(experiment, body, text, made[body].limited[i], 0.05, "docs/shells.md");
            snprintf(text, sizeof text, "%s, area / area at rest", fibres[i]);
            b_expect(experiment, body, text, made[body].areas[i], 1, 0.05, "docs/shells.md");
        }
    b_begin_contact_claim(experiment, NULL);
    for (int body = 0; body < experiment->body_count; body++)
        b_judge_contacts(experiment, body, "all four", &made[body].contacts);
}

static pel_status run_figure_19_20(lab_experiment *experiment)
{
    static caved made[LAB_BODIES];
    const char *runs[LAB_CURVES];
    int count = 0;
    pel_status status = PEL_OK;
    memset(made, 0, sizeof made);
    for (int body = 0; status == PEL_OK && body < experiment->body_count; body++)
        status = run_fibres(experiment, body, &made[body]);
    if (status != PEL_OK)
        return status;
    judge_fibres(experiment, made);
    for (int body = 0; body < experiment->body_count && count + 1 < LAB_CURVES; body++) {
        runs[count++] = made[body].names[0];
        runs[count++] = made[body].names[1];
    }
    status = b_plot_volumes(experiment, "figure 20: volume without and with fibres", runs, runs, count);
    for (int body = 0; status == PEL_OK && body < experiment->body_count && body < 2; body++) {
        lab_picture picture = {.caption = "figure 19: no fibres, and the three energies, in frame 100",
                               .labels = {"none", "arap", "sqrt", "stvk"},
                               .run_count = FIBRES,
                               .frames = {100},
                               .frame_count = 1,
                               .columns = FIBRES,
                               .azimuth = 35,
                               .elevation = 20};
        for (int i = 0; i < FIBRES; i++)
            picture.runs[i] = made[body].names[i];
        status = lab_add_picture(experiment, &picture);
    }
    return status;
}

const lab_case b_figure_19_20 = {
    .name = "b-figure19-20",
    .doc = "regions of fibres that cave in, three energies",
    .group = "paper B",
    .place = "section 6, figures 19 and 20",
    .run = run_figure_19_20,
};

/* ---- table 2 ---- */

/* pairs of a vertex and a triangle without it, and of two edges without a common vertex */
static double all_pairs(const pel_mesh *mesh)
{
    double vertices = mesh->vertex_count, triangles = mesh->triangle_count, edges = 1.5 * triangles, touching = 0;
    int32_t *degree = calloc((size_t)mesh->vertex_count, sizeof *degree);
    for (int32_t t = 0; degree != NULL && t < mesh->triangle_count; t++)
        for (int k = 0; k < 3; k++)
            degree[mesh->triangles[t][k]]++;
    for (int32_t v = 0; degree != NULL && v < mesh->vertex_count; v++)
        touching += 0.5 * degree[v] * (degree[v] - 1);
    free(degree);
    return vertices * triangles - 3 * triangles + 0.5 * edges * (edges - 1) - touching;
}

/* processor time of a cubic of Bridson and others, from pairs of triangles spread over two frames of a run [s] */
static pel_status time_cubic(lab_experiment *experiment, const char *run, double *seconds)
{
    enum { PAIRS = 200000 };
    pel_mesh *start = NULL, *end = NULL;
    pel_status status = b_read_frame(experiment, run, 60, &start);
    if (status == PEL_OK)
        status = b_read_frame(experiment, run, 61, &end);
    int hits = 0;
    double begin = pel_thread_seconds();
    for (int i = 0; status == PEL_OK && i < PAIRS; i++) {
        double from[4][3], to[4][3];
        int32_t vertex = (int32_t)((int64_t)i * 7919 % start->vertex_count),
                triangle = (int32_t)((int64_t)i * 104729 % start->triangle_count);
        for (int k = 0; k < 4; k++) {
            int32_t v = k == 0 ? vertex : start->triangles[triangle][k - 1];
            memcpy(from[k], start->positions[v], sizeof from[k]);
            memcpy(to[k], end->positions[v], sizeof to[k]);
        }
        pel_ccd_hit hit;
        hits += pel_ccd_bridson((const double(*)[3])from, (const double(*)[3])to, false, 1e-4, 1e-9, &hit);
    }
    *seconds = (pel_thread_seconds() - begin) / PAIRS;
    pel_mesh_destroy(start);
    pel_mesh_destroy(end);
    return hits < 0 ? PEL_BAD_FORMAT : status;
}

typedef struct search {
    double all, cubic_seconds; /* a frame without culling */
    /* a frame by boxes, filter and cubic, processor time; cubics of the method of ours */
    double candidates, cubics, milliseconds, ours;
    double volume;
    b_contacts contacts;
} search;

static pel_status run_search(lab_experiment *experiment, int body, char names[2][64], search *made)
{
    static const char *const methods[2] = {"bridson", "conservative"};
    pel_mesh *mesh = NULL;
    pel_status status = PEL_OK;
    double share = 1; /* of the wall time of the first run in which this process, of one thread, had a processor */
    for (int i = 0; status == PEL_OK && i < 2; i++) {
        char method[64];
        pel_run_summary summary = {0};
        double begin = pel_seconds(), begin_busy = pel_thread_seconds();
        snprintf(method, sizeof method, "contact={ self: true, method: %s }", methods[i]);
        const char *settings[] = {method, "bodies.0.bending.weight=auto", "stop.frames=150", "solver.threads=1", NULL};
        status = b_shrink(experiment, body, methods[i], settings, &summary);
        b_run_name(experiment, body, methods[i], names[i]);
        if (i == 0)
            share = fmin((pel_thread_seconds() - begin_busy) / (pel_seconds() - begin), 1);
        if (status == PEL_OK)
            status = b_add_contacts(experiment, body, methods[i], &summary, &made->contacts);
        made->volume = summary.volume_ratio_final;
    }
    const char *const columns[3] = {"contact_candidates", "contact_cubics", "contact_find_ms"};
    double *const numbers[3] = {&made->candidates, &made->cubics, &made->milliseconds};
    for (int i = 0; status == PEL_OK && i < 3; i++)
        status = b_mean(experiment, names[0], columns[i], numbers[i]);
    made->milliseconds *= share;
    if (status == PEL_OK)
        status = b_mean(experiment, names[1], "contact_cubics", &made->ours);
    if (status == PEL_OK)
        status = b_read_frame(experiment, names[0], 0, &mesh);
    if (status == PEL_OK) {
        made->all = all_pairs(mesh);
        status = time_cubic(experiment, names[0], &made->cubic_seconds);
    }
    pel_mesh_destroy(mesh);
    return status;
}

/* The paper's table has the columns 2, 3 and 5 of this one; its text calls the gain significant. */
static void tabulate(lab_experiment *experiment, const search made[LAB_BODIES])
{
    lab_begin_table(experiment, "Table 2: a frame on one thread",
                    "body|cubics without culling|their time|cubics after boxes and filter|time of the search|"
                    "time without / with culling|cubics of our method");
    for (int body = 0; body < experiment->body_count; body++) {
        const search *one = &made[body];
        double all = one->all * one->cubic_seconds;
        char cells[240];
        snprintf(cells, sizeof cells, "%.40s|%.3g|%.2g s|%.3g|%.2g ms|%.2g|%.2g", experiment->bodies[body].name,
                 one->all, all, one->cubics, one->milliseconds, 1e3 * all / one->milliseconds, one->ours);
        lab_add_row(experiment, cells);
    }
}

static pel_status run_table_2(lab_experiment *experiment)
{
    static char names[LAB_BODIES][2][64];
    search made[LAB_BODIES] = {{0}};
    pel_status status = PEL_OK;
    for (int body = 0; status == PEL_OK && body < experiment->body_count; body++)
        status = run_search(experiment, body, names[body], &made[body]);
    if (status != PEL_OK)
        return status;
    lab_begin_claim(experiment, LAB_PAPER, "boxes and the filter make collision detection far faster (table 2)", NULL);
    lab_by_construction(experiment, "all pairs grow as the square of the triangles, boxes near each other as their "
                                    "number");
    for (int body = 0; body < experiment->body_count; body++) {
        const search *one = &made[body];
        b_at_least(experiment, body, "time without culling / with boxes and filter",
                   1e3 * one->all * one->cubic_seconds / one->milliseconds, 100, B_PAPER ", table 2; 100 is ours");
        b_tell(experiment, body, "cubics a frame without culling", one->all, (double)NAN, "all pairs, counted");
        b_tell(experiment, body, "their time [s], from 200,000 of them", one->all * one->cubic_seconds, (double)NAN,
               "");
        b_tell(experiment, body, "pairs of boxes a frame", one->candidates, (double)NAN, "");
        b_tell(experiment, body, "cubics a frame, boxes and filter", one->cubics, (double)NAN, "");
        b_tell(experiment, body, "search a frame [ms]", one->milliseconds, (double)NAN, "");
        b_tell(experiment, body, "cubics a frame, method conservative", one->ours, (double)NAN, "");
    }
    tabulate(experiment, made);
    lab_begin_claim(experiment, LAB_REGRESSION, "few pairs of boxes need the cubic", NULL);
    for (int body = 0; body < experiment->body_count; body++)
        b_at_most(experiment, body, "cubics / pairs of boxes", made[body].cubics / fmax(made[body].candidates, 1), 0.4,
                  "our own runs");
    b_begin_contact_claim(experiment, NULL);
    for (int body = 0; body < experiment->body_count; body++) {
        b_judge_contacts(experiment, body, "both", &made[body].contacts);
        b_tell(experiment, body, "volume at the end", made[body].volume, (double)NAN, "");
    }
    lab_picture picture = {.caption = "shells that touch themselves, frames 100 and 150 (or the last)",
                           .run_count = experiment->body_count,
                           .frames = {100, -1},
                           .frame_count = 2,
                           .columns = 2 * experiment->body_count,
                           .field = "none",
                           .azimuth = 35,
                           .elevation = 20};
    for (int body = 0; body < experiment->body_count; body++) {
        picture.runs[body] = names[body][1];
        picture.labels[body] = experiment->bodies[body].name;
    }
    return lab_add_picture(experiment, &picture);
}

const lab_case b_table_2 = {
    .name = "b-table2",
    .doc = "cubics and time of collision detection, without culling, by boxes and filter, by axes",
    .group = "paper B",
    .place = "section 6, table 2",
    .run = run_table_2,
};
