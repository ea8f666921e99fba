/* The frames of a run as a stream of bytes for web/src/data.js, which reads it in the same order. A frame is

       the corners of its triangles, if no frame before had these: each as the difference from the corner before
       x of all vertices, y, z
       for each field: each component, or the magnitudes

   Corners are 32-bit, positions 16-bit numbers from 0 (least) to 65535 (largest of the run), fields the same or 8-bit.
   Where the frame before has the same triangles, positions and fields are differences from it. Differences wrap around
   and are folded (0, -1, 1, -2, ... become 0, 1, 2, 3, ...), so that small ones have zeros in their high bytes. Each
   list of numbers is written as its low bytes, then its next higher bytes, and so on: zlib finds the zeros together. */
#include "report/read.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "math/extremes.h"

#include <math.h>
#include <string.h>

/* from this many frames on the size of all is foreseen */
enum { TRIAL_FRAMES = 10 };

typedef struct encoder {
    pel_report_run *run;
    size_t channel_count; /* lists of numbers in a frame */
    uint16_t *numbers;    /* (channel_count x vertex_limit) of the frame before */
    unsigned char *bytes; /* one list */
    int32_t topology;     /* of the frame before, -1 = none */
} encoder;

static int32_t count_channels(const pel_report_field *field, const pel_report_plan *plan)
{
    return plan->components && field->component_count <= 3 ? field->component_count : 1;
}

static pel_status make_encoder(encoder *e, pel_report_run *run, pel_error *error)
{
    *e = (encoder){.run = run, .channel_count = 3, .topology = -1};
    for (int32_t f = 0; f < run->field_count; f++)
        e->channel_count += (size_t)count_channels(&run->fields[f], &run->plan);
    size_t list = 2 * (size_t)run->vertex_limit, corners = 12 * (size_t)run->triangle_limit;
    return PEL_ALLOCATE_ALL(PEL_ROOM(e->numbers, e->channel_count * (size_t)run->vertex_limit),
                            PEL_ROOM(e->bytes, list > corners ? list : corners))
               ? PEL_OK
               : pel_fail_memory(error);
}

static void free_encoder(encoder *e)
{
    pel_free(e->bytes);
    pel_free(e->numbers);
}

/* ---- lists of numbers ---- */

static uint32_t fold(uint32_t difference)
{
    return difference << 1 ^ (uint32_t)((int32_t)difference >> 31);
}

static pel_status add_corners(encoder *e, const pel_mesh *mesh, pel_error *error)
{
    size_t count = 3 * (size_t)mesh->triangle_count;
    const int32_t *corners = mesh->triangles[0];
    for (size_t i = 0; i < count; i++) {
        uint32_t folded = fold((uint32_t)corners[i] - (i > 0 ? (uint32_t)corners[i - 1] : 0));
        for (size_t b = 0; b < 4; b++)
            e->bytes[b * count + i] = (unsigned char)(folded >> 8 * b);
    }
    return pel_report_pack_add(&e->run->pack, e->bytes, 4 * count, error);
}

/* adds one list; `values` steps by `step` */
static pel_status add_channel(encoder *e, size_t channel, const double *values, size_t step, size_t count,
                              const double range[2], int32_t bits, pel_error *error)
{
    uint16_t *last = e->numbers + channel * (size_t)e->run->vertex_limit;
    double steps = bits == 16 ? 65535 : 255, scale = range[1] > range[0] ? steps / (range[1] - range[0]) : 0;
    for (size_t v = 0; v < count; v++) {
        double scaled = (values[v * step] - range[0]) * scale;
        uint16_t number = (uint16_t)(scaled > 0 ? (scaled < steps ? scaled + 0.5 : steps) : 0);
        uint16_t difference = (uint16_t)(number - last[v]);
        int32_t wrapped = bits == 16 ? (int16_t)difference : (int8_t)(uint8_t)difference;
        uint32_t folded = fold((uint32_t)wrapped);
        e->bytes[v] = (unsigned char)folded;
        if (bits == 16)
            e->bytes[count + v] = (unsigned char)(folded >> 8);
        last[v] = number;
    }
    return pel_report_pack_add(&e->run->pack, e->bytes, count * (size_t)(bits / 8), error);
}

/* ---- frames ---- */

static void take_magnitudes(pel_field *field, int32_t vertex_count)
{
    int32_t components = field->component_count;
    for (int32_t v = 0; v < vertex_count; v++) {
        const double *value = field->values + (size_t)v * (size_t)components;
        double squares = 0;
        for (int32_t i = 0; i < components; i++)
            squares += value[i] * value[i];
        field->values[v] = components > 1 ? sqrt(squares) : value[0];
    }
    field->component_count = 1;
}

static pel_field *find_field(pel_mesh *mesh, const pel_report_field *known)
{
    for (int32_t f = 0; f < mesh->field_count; f++)
        if (strcmp(mesh->fields[f].name, known->name) == 0 && mesh->fields[f].component_count == known->component_count)
            return &mesh->fields[f];
    return NULL;
}

/* check that the frame is unchanged since the survey */
static pel_status check_unchanged(const pel_report_run *run, int32_t frame, pel_mesh *mesh, pel_error *error)
{
    const pel_report_topology *topology = &run->topologies[run->frame_topology[frame]];
    bool same = mesh->vertex_count == topology->vertex_count && mesh->triangle_count == topology->triangle_count;
    for (int32_t f = 0; f < run->field_count; f++)
        same = same && find_field(mesh, &run->fields[f]) != NULL;
    if (same)
        return PEL_OK;
    pel_fail(error, PEL_BAD_FORMAT, "the frame changed while it was read");
    pel_fail_remedy(error, "wait until the run has ended");
    pel_fail_place(error, run->frames->paths[frame], 0, 0);
    return PEL_BAD_FORMAT;
}

static pel_status add_field(encoder *e, const pel_report_field *known, pel_mesh *mesh, size_t *channel,
                            pel_error *error)
{
    pel_field *field = find_field(mesh, known);
    size_t channels = (size_t)count_channels(known, &e->run->plan);
    const double magnitudes[2] = {known->magnitude_low, known->magnitude_high},
                 components[2] = {known->low, known->high};
    if (channels == 1)
        take_magnitudes(field, mesh->vertex_count);
    pel_status status = PEL_OK;
    for (size_t i = 0; status == PEL_OK && i < channels; i++)
        status = add_channel(e, (*channel)++, field->values + i, channels, (size_t)mesh->vertex_count,
                             channels == 1 ? magnitudes : components, e->run->plan.bits, error);
    return status;
}

static pel_status add_frame(encoder *e, int32_t frame, pel_error *error)
{
    pel_report_run *run = e->run;
    pel_mesh *mesh;
    pel_status status = pel_frames_read(run->frames, frame, &mesh, error);
    if (status != PEL_OK)
        return status;
    pel_report_topology *topology = &run->topologies[run->frame_topology[frame]];
    status = check_unchanged(run, frame, mesh, error);
    if (status == PEL_OK && !topology->written)
        status = add_corners(e, mesh, error);
    topology->written = true;
    if (e->topology != run->frame_topology[frame])
        memset(e->numbers, 0, e->channel_count * (size_t)run->vertex_limit * sizeof *e->numbers);
    e->topology = run->frame_topology[frame];
    size_t channel = 0;
    for (size_t i = 0; status == PEL_OK && i < 3; i++) {
        const double range[2] = {run->low[i], run->high[i]};
        status = add_channel(e, channel++, mesh->positions[0] + i, 3, (size_t)mesh->vertex_count, range, 16, error);
    }
    for (int32_t f = 0; status == PEL_OK && f < run->field_count; f++)
        status = add_field(e, &run->fields[f], mesh, &channel, error);
    pel_mesh_destroy(mesh);
    return status;
}

bool pel_report_run_keeps(const pel_report_run *run, int32_t frame)
{
    return frame % run->plan.stride == 0 || frame == run->frames->frame_count - 1;
}

/* Packs all frames that the plan keeps; `estimate` gets the size of all of them, guessed when the limit was passed. */
static pel_status pack_frames(pel_report_run *run, size_t limit, double *estimate, pel_error *error)
{
    encoder e;
    size_t first_size = 0;
    for (int32_t i = 0; i < run->topology_count; i++)
        run->topologies[i].written = false;
    run->frames_kept = 0;
    pel_report_pack_free(&run->pack);
    pel_status status = make_encoder(&e, run, error);
    if (status == PEL_OK)
        status = pel_report_pack_open(&run->pack, limit, error);
    int32_t frame = 0;
    for (; status == PEL_OK && frame < run->frames->frame_count && !run->pack.full; frame++) {
        if (!pel_report_run_keeps(run, frame))
            continue;
        status = add_frame(&e, frame, error);
        if (run->frames_kept++ == 0)
            first_size = run->pack.size;
        double done = (double)(frame + 1) / run->frames->frame_count;
        *estimate = (double)first_size + (double)(run->pack.size - first_size) / done;
        run->pack.full = run->pack.full || (run->frames_kept >= TRIAL_FRAMES && *estimate > 1.1 * (double)limit);
    }
    if (run->pack.full && run->frames_kept == 1)
        *estimate = HUGE_VAL;
    if (status == PEL_OK)
        status = pel_report_pack_close(&run->pack, error);
    *estimate = pel_max(*estimate, (double)run->pack.size);
    free_encoder(&e);
    return status;
}

/* ---- the plan ---- */

/* bytes of a vertex before packing */
static double vertex_bytes(const pel_report_run *run, const pel_report_plan *plan)
{
    double bytes = 6;
    for (int32_t f = 0; f < run->field_count; f++)
        bytes += count_channels(&run->fields[f], plan) * plan->bits / 8;
    return bytes;
}

/* the next smaller plan that may fit, from the size of the last one; false if there is none */
static bool shrink_plan(pel_report_run *run, double estimate, double limit)
{
    const pel_report_plan ladder[] = {{true, 16, 1}, {false, 16, 1}, {false, 8, 1}};
    enum { RUNGS = sizeof ladder / sizeof ladder[0] };
    pel_report_plan *plan = &run->plan;
    double bytes = vertex_bytes(run, plan);
    for (int i = 1; i < RUNGS && plan->stride == 1; i++) {
        double less = vertex_bytes(run, &ladder[i]);
        if (less < vertex_bytes(run, plan) && estimate * less / bytes <= limit) {
            *plan = ladder[i];
            return true;
        }
    }
    estimate *= vertex_bytes(run, &ladder[RUNGS - 1]) / bytes;
    *plan = (pel_report_plan){false, 8, plan->stride};
    if (plan->stride >= run->frames->frame_count)
        return false;
    double factor = pel_min(pel_max(estimate / limit, 1.05), 1e6);
    double stride = ceil(plan->stride * factor);
    plan->stride = stride < run->frames->frame_count ? (int32_t)stride : run->frames->frame_count;
    return true;
}

pel_status pel_report_run_pack(pel_report_run *run, size_t limit, pel_error *error)
{
    double estimate = 0;
    run->plan = (pel_report_plan){true, 16, 1};
    pel_status status = pack_frames(run, limit, &estimate, error);
    while (status == PEL_OK && run->pack.full) {
        if (!shrink_plan(run, estimate, (double)limit)) {
            pel_fail(error, PEL_BAD_ARGUMENT, "the first and the last frame alone exceed the limit of the report");
            pel_fail_remedy(error, "raise the limit (--limit), or include fewer fields (--field)");
            pel_fail_place(error, run->folder, 0, 0);
            return PEL_BAD_ARGUMENT;
        }
        status = pack_frames(run, limit, &estimate, error);
    }
    return status;
}
