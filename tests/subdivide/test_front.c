#include "failing_malloc.h"
#include "sample.h"

#include "subdivide/front.h"

typedef struct scene {
    pel_mesh *mesh;
    pel_lod_forest *forest;
    pel_front *front;
} scene;

static scene make_scene(pel_mesh *mesh, int32_t depth)
{
    scene made = {.mesh = mesh};
    assert_int_equal(pel_lod_forest_create(mesh, depth, 0, &made.forest, NULL), PEL_OK);
    assert_int_equal(pel_front_create(made.forest, &made.front, NULL), PEL_OK);
    return made;
}

static void end_scene(scene *made)
{
    pel_front_destroy(made->front);
    pel_lod_forest_destroy(made->forest);
    pel_mesh_destroy(made->mesh);
}

static void update(pel_front *front)
{
    int32_t expected = pel_front_close(front);
    pel_front_commit(front);
    assert_int_equal(front->triangle_count, expected);
}

/* vertices within `rings` - 1 edges of v on the base refine the triangles around them */
static void mark_rings(const scene *made, int32_t v, int32_t rings, int32_t level, bool marked)
{
    const pel_topology *base = made->forest->levels[0];
    pel_front_mark_vertex(made->front, v, level, marked);
    int32_t first = base->corner_of_vertex[v], h = first;
    while (rings > 1 && h >= 0) {
        mark_rings(made, pel_half_edge_target(base, h), rings - 1, level, marked);
        h = pel_half_edge_turn(base, h);
        if (h == first)
            break;
    }
}

/* paper A's table: 252/500 becomes 294/584 where the 2-ring of a vertex is refined, 1002/2000 as a whole */
static void test_paper_numbers(void **unused)
{
    (void)unused;
    scene made = make_scene(sample_sphere(5), 1);
    int count_294 = 0, count_292 = 0, count_287 = 0;
    for (int32_t v = 0; v < 252; v++) {
        mark_rings(&made, v, 2, 1, true);
        update(made.front);
        count_294 += made.front->vertex_count == 294 && made.front->triangle_count == 584;
        count_292 += made.front->vertex_count == 292 && made.front->triangle_count == 580;
        count_287 += made.front->vertex_count == 287 && made.front->triangle_count == 570;
        assert_int_equal(made.front->added_count, made.front->vertex_count - 252);
        mark_rings(&made, v, 2, 1, false);
        update(made.front);
        assert_int_equal(made.front->vertex_count, 252);
        assert_int_equal(made.front->edge_count, 750);
    }
    assert_int_equal(count_294, 180);
    assert_int_equal(count_292, 60);
    assert_int_equal(count_287, 12);
    for (int32_t t = 0; t < 500; t++)
        pel_front_mark(made.front, t, true);
    update(made.front);
    assert_int_equal(made.front->vertex_count, 1002);
    assert_int_equal(made.front->triangle_count, 2000);
    assert_true(pel_front_is_valid(made.front));
    end_scene(&made);
}

/* a marked triangle that is bisected turns red, and a leaf between two red ones as well */
static void test_rules(void **unused)
{
    (void)unused;
    scene made = make_scene(sample_octahedron(), 3);
    pel_front *front = made.front;
    pel_front_mark(front, 0, true);
    update(front);
    assert_int_equal(front->triangle_count, 4 + 3 * 2 + 4);
    assert_int_equal(front->red_count, 1);
    const pel_topology *base = made.forest->levels[0];
    int32_t across = base->twin[0] / 3;
    assert_true(pel_front_is_green(front->shapes[across]));
    pel_front_mark(front, across, true);
    update(front);
    assert_int_equal(front->shapes[across], PEL_FRONT_RED);
    assert_int_equal(front->red_count, 2);
    assert_true(pel_front_is_valid(front));
    /* two opposite neighbours of a triangle make it red; taking one away frees it */
    pel_front_mark(front, 0, false);
    pel_front_mark(front, across, false);
    pel_front_mark(front, base->twin[1] / 3, true);
    pel_front_mark(front, base->twin[2] / 3, true);
    update(front);
    assert_int_equal(front->shapes[0], PEL_FRONT_RED);
    assert_false(pel_front_is_marked(front, 0));
    assert_true(pel_front_is_valid(front));
    pel_front_mark(front, base->twin[2] / 3, false);
    update(front);
    assert_true(pel_front_is_green(front->shapes[0]));
    assert_true(pel_front_is_valid(front));
    /* three levels down at one corner: levels fall off by one */
    pel_front_mark(front, front->node_begin[2] + 16 * 3, true);
    update(front);
    assert_true(pel_front_is_valid(front));
    assert_int_equal(front->shapes[front->node_begin[2] + 16 * 3], PEL_FRONT_RED);
    end_scene(&made);
}

/* every triangle of a ring of valence 8 holds its neighbours up: none may stay when the mark goes */
static void test_no_self_support(void **unused)
{
    (void)unused;
    random_state random = {5};
    scene made = make_scene(sample_ring(8, true, &random), 2);
    pel_front *front = made.front;
    for (int32_t t = 0; t < 16; t += 2)
        pel_front_mark(front, t, true);
    update(front);
    assert_int_equal(front->red_count, 16);
    for (int32_t t = 0; t < 16; t += 2)
        pel_front_mark(front, t, false);
    update(front);
    assert_int_equal(front->red_count, 0);
    assert_int_equal(front->triangle_count, 16);
    assert_true(pel_front_is_valid(front));
    end_scene(&made);
}

static void assert_base(const scene *made)
{
    const pel_topology *base = made->forest->levels[0];
    assert_int_equal(made->front->triangle_count, base->triangle_count);
    assert_int_equal(made->front->vertex_count, base->vertex_count);
    assert_int_equal(made->front->edge_count, base->edge_count);
    pel_front_triangle *surface = calloc((size_t)base->triangle_count, sizeof *surface);
    pel_front_surface(made->front, surface);
    for (int32_t t = 0; t < base->triangle_count; t++)
        assert_memory_equal(surface[t].vertices, base->triangles[t], sizeof base->triangles[t]);
    free(surface);
}

/* the surface that the same marks give on a fresh front, set in another order and over several events */
static void assert_set_semantics(const scene *made, random_state *random)
{
    const pel_front *front = made->front;
    pel_front *fresh;
    assert_int_equal(pel_front_create(made->forest, &fresh, NULL), PEL_OK);
    int32_t first = (int32_t)random_integer(random, 0, front->red_limit - 1), stride = 7919;
    for (int32_t i = 0; i < front->red_limit; i++) {
        int32_t node = (int32_t)((first + (int64_t)i * stride) % front->red_limit);
        if (pel_front_is_marked(front, node))
            pel_front_mark(fresh, node, true);
        if (i % (1 + front->red_limit / 3) == 0)
            update(fresh);
    }
    for (int32_t node = 0; node < front->red_limit; node++)
        if (pel_front_is_marked(front, node))
            pel_front_mark(fresh, node, true);
    update(fresh);
    assert_int_equal(fresh->triangle_count, front->triangle_count);
    pel_front_triangle *ours = calloc((size_t)front->triangle_count, sizeof *ours);
    pel_front_triangle *theirs = calloc((size_t)front->triangle_count, sizeof *theirs);
    pel_front_surface(front, ours);
    pel_front_surface(fresh, theirs);
    assert_memory_equal(ours, theirs, (size_t)front->triangle_count * sizeof *ours);
    free(ours);
    free(theirs);
    pel_front_destroy(fresh);
}

/* what an event says it changed is what changed */
static void assert_changes(const pel_front *front, const uint8_t *shapes_before, const uint8_t *active_before)
{
    int32_t changed = 0, came = 0, went = 0;
    for (int32_t n = 0; n < front->node_count; n++)
        changed += shapes_before[n] != front->shapes[n];
    assert_int_equal(changed, front->change_count);
    for (int32_t c = 0; c < front->change_count; c++) {
        const pel_front_change *change = &front->changes[c];
        assert_true(change->before == shapes_before[change->node] && change->after == front->shapes[change->node]);
    }
    int32_t vertex_count = front->forest->levels[front->forest->depth]->vertex_count;
    for (int32_t v = 0; v < vertex_count; v++) {
        came += !active_before[v] && pel_front_has_vertex(front, v);
        went += active_before[v] && !pel_front_has_vertex(front, v);
    }
    assert_int_equal(came, front->added_count);
    assert_int_equal(went, front->removed_count);
    for (int32_t i = 1; i < front->added_count; i++)
        assert_true(front->added_vertices[i - 1] < front->added_vertices[i]);
}

static void random_marks(pel_front *front, random_state *random)
{
    int32_t vertex_count = front->forest->levels[front->forest->depth]->vertex_count;
    for (int64_t n = random_integer(random, 1, 6); n > 0; n--) {
        bool marked = random_integer(random, 0, 9) < 5;
        if (random_integer(random, 0, 1) == 0)
            pel_front_mark(front, (int32_t)random_integer(random, 0, front->node_count - 1), marked);
        else
            pel_front_mark_vertex(front, (int32_t)random_integer(random, 0, vertex_count - 1),
                                  (int32_t)random_integer(random, 1, front->forest->depth), marked);
    }
    if (random_integer(random, 0, 20) == 0)
        for (int32_t n = 0; n < front->red_limit; n++)
            pel_front_mark(front, n, false);
}

static void fuzz(scene *made, int sequences, random_state *random)
{
    pel_front *front = made->front;
    size_t node_count = (size_t)front->node_count;
    size_t vertex_count = (size_t)made->forest->levels[made->forest->depth]->vertex_count;
    uint8_t *shapes = malloc(node_count), *active = malloc(vertex_count);
    for (int s = 0; s < sequences; s++) {
        memcpy(shapes, front->shapes, node_count);
        for (size_t v = 0; v < vertex_count; v++)
            active[v] = pel_front_has_vertex(front, (int32_t)v);
        random_marks(front, random);
        if (s % 5 == 0)
            pel_front_close(front); /* a close without a commit leaves no trace */
        if (s % 10 == 0)
            random_marks(front, random);
        update(front);
        assert_true(pel_front_is_valid(front));
        assert_changes(front, shapes, active);
        if (s % 50 == 0)
            assert_set_semantics(made, random);
        if (front->marked_count == 0)
            assert_base(made);
    }
    for (int32_t n = 0; n < front->red_limit; n++)
        pel_front_mark(front, n, false);
    update(front);
    assert_base(made);
    assert_true(pel_front_is_valid(front));
    free(shapes);
    free(active);
}

static void test_fuzz(void **unused)
{
    (void)unused;
    int sequences = LONG(100000, 10000) / 5;
    random_state random = {2006};
    pel_mesh *meshes[5] = {sample_sphere(3), sample_tetrahedron(), sample_ring(40, false, &random),
                           sample_random(&random), sample_random(&random)};
    const int32_t depths[5] = {2, 4, 2, 2, 3};
    for (int m = 0; m < 5; m++) {
        scene made = make_scene(meshes[m], depths[m]);
        fuzz(&made, sequences, &random);
        end_scene(&made);
    }
}

/* a broken structure is seen */
static void test_validity(void **unused)
{
    (void)unused;
    scene made = make_scene(sample_sphere(3), 2);
    pel_front *front = made.front;
    pel_front_mark_vertex(front, 9, 2, true);
    update(front);
    assert_true(pel_front_is_valid(front));
    int32_t *vertex = &front->triangles[front->triangle_count - 1].vertices[1], kept = *vertex;
    *vertex = *vertex == 0;
    assert_false(pel_front_is_valid(front));
    *vertex = kept;
    front->red_counts[3] ^= 1;
    assert_false(pel_front_is_valid(front));
    front->red_counts[3] ^= 1;
    /* a place of a triangle that is not there, and a second one of a whole triangle */
    for (int32_t node = 0, seen = 0; seen != 3; node++) {
        int kind = front->shapes[node] == PEL_FRONT_ABSENT ? 1 : front->shapes[node] == PEL_FRONT_WHOLE ? 2 : 0;
        for (int k = kind == 1 ? 0 : 1; kind != 0 && k < 2; k++) {
            kept = front->place_of_node[node][k];
            front->place_of_node[node][k] = 0;
            assert_false(pel_front_is_valid(front));
            front->place_of_node[node][k] = kept;
        }
        seen |= kind;
    }
    assert_true(pel_front_is_valid(front));
    front->edges[0] = front->edges[1];
    assert_false(pel_front_is_valid(front));
    end_scene(&made);
}

static void test_events_do_not_allocate(void **unused)
{
    (void)unused;
    random_state random = {8};
    scene made = make_scene(sample_sphere(5), 2);
    failing_malloc_begin(0);
    for (int i = 0; i < 200; i++) {
        random_marks(made.front, &random);
        pel_front_close(made.front);
        pel_front_commit(made.front);
    }
    allocation_count count = failing_malloc_end();
    assert_int_equal(count.calls, 0);
    end_scene(&made);
}

static pel_status front_case(const void *forest, pel_error *error)
{
    pel_front *front = (pel_front *)1;
    pel_status status = pel_front_create(forest, &front, error);
    assert_true((status == PEL_OK) == (front != NULL));
    pel_front_destroy(front);
    return status;
}

static void test_out_of_memory(void **unused)
{
    (void)unused;
    scene made = make_scene(sample_sphere(3), 1);
    assert_true(for_every_allocation_failure(front_case, made.forest) > 10);
    end_scene(&made);
}

/* prints what the event of paper A's table costs; on a large mesh the same, as it depends on what changes alone */
static void test_event_time(void **unused)
{
    (void)unused;
    const int32_t frequencies[2] = {5, 45};
    for (int i = 0; i < 2; i++) {
        scene made = make_scene(sample_sphere(frequencies[i]), 2);
        int32_t v = made.mesh->vertex_count / 2;
        double refine = HUGE_VAL, coarsen = HUGE_VAL;
        for (int round = 0; round < ROUNDS(2000, 20); round++) {
            double start = pel_seconds();
            mark_rings(&made, v, 2, 1, true);
            update(made.front);
            double middle = pel_seconds();
            mark_rings(&made, v, 2, 1, false);
            update(made.front);
            double end = pel_seconds();
            refine = fmin(refine, middle - start);
            coarsen = fmin(coarsen, end - middle);
        }
        print_message("%d triangles: refine %.1f us, coarsen %.1f us\n", (int)made.mesh->triangle_count, 1e6 * refine,
                      1e6 * coarsen);
        assert_true(made.front->triangle_count == made.mesh->triangle_count);
        end_scene(&made);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_paper_numbers),   cmocka_unit_test(test_rules),
        cmocka_unit_test(test_no_self_support), cmocka_unit_test(test_fuzz),
        cmocka_unit_test(test_validity),        cmocka_unit_test(test_events_do_not_allocate),
        cmocka_unit_test(test_out_of_memory),   cmocka_unit_test(test_event_time),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
