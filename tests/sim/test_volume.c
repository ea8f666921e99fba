/* Bodies filled with tetrahedra under the methods that know a material: uniform strain, a bar under tension, momentum,
   free fall, a crushed cube, threads, and refusals. */
#include "failing_malloc.h"
#include "random.h"
#include "solid_fixture.h"

#include "math/vec3.h"
#include "pellicle/observe.h"
#include "pellicle/shape.h"
#include "pellicle/sim_adjoint.h"
#include "pellicle/sim_forces.h"
#include "pellicle/sim_ledger.h"
#include "pellicle/sim_surface.h"
#include "pellicle/tear.h"

static stage make_stage(pel_mesh *mesh, const pel_body_def *body, pel_method method, double dt)
{
    stage s = {.mesh = mesh, .model = make_model(body)};
    pel_sim_def def = lone_sim(s.model, method, dt);
    s.sim = make_sim(&def);
    return s;
}

static int32_t surface_count(const pel_mesh *mesh)
{
    int32_t count = 0;
    for (int32_t t = 0; t < mesh->triangle_count; t++)
        for (int k = 0; k < 3; k++)
            count = mesh->triangles[t][k] >= count ? mesh->triangles[t][k] + 1 : count;
    return count;
}

/* the patch test: a uniform strain has the energy of the law, and no force inside */
static void uniform_strain_is_exact(void **state)
{
    (void)state;
    const double f[9] = {1.2, 0.1, -0.05, 0.07, 0.9, 0.2, 0, -0.1, 1.1};
    for (int kind = 0; kind < PEL_VOLUME_COUNT; kind++) {
        pel_mesh *mesh = make_block(1, 0.7, 1.3, 0.25);
        const pel_body_def body = solid_body(mesh, kind, 500, 0.35);
        stage s = make_stage(mesh, &body, PEL_METHOD_EXPLICIT, 1e-5);
        double *x = positions_of(&s), *force = malloc(3 * sizeof *force * (size_t)mesh->vertex_count), density;
        for (int32_t v = 0; v < mesh->vertex_count; v++)
            for (int i = 0; i < 3; i++)
                x[3 * v + i] = pel_vec3_dot(f + 3 * i, mesh->positions[v]) + 0.3;
        assert_int_equal(pel_sim_set_positions(s.sim, 0, x, NULL), PEL_OK);
        pel_sim_get_forces(s.sim, 0, force);
        for (int32_t v = surface_count(mesh); v < mesh->vertex_count; v++)
            assert_near(pel_vec3_length(force + 3 * v), 0, IN_FLOAT(1e-11, 1e-3));
        pel_sim_measures measures;
        pel_sim_measure(s.sim, &measures);
        assert_int_equal(pel_volume_density((pel_volume_kind)kind, 500, 0.35, 0.2, f, &density, NULL, NULL), PEL_OK);
        assert_near(measures.elastic_energy, density * 0.7 * 1.3, IN_FLOAT(1e-9, 1e-2));
        double *energies = malloc(sizeof *energies * (size_t)mesh->vertex_count), sum = 0;
        assert_int_equal(pel_observe(s.sim, pel_field_find("energy"), 0, energies, NULL), PEL_OK);
        for (int32_t v = 0; v < mesh->vertex_count; v++)
            sum += energies[v];
        assert_near(sum, measures.elastic_energy, IN_FLOAT(1e-9, 1e-2));
        free(energies);
        free(force);
        free(x);
        end_stage(&s);
    }
}

/* kg: a third of each triangle on its corners, of those at the height z */
static void end_areas(const pel_mesh *mesh, double z, double *areas)
{
    memset(areas, 0, (size_t)mesh->vertex_count * sizeof *areas);
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        const int32_t *v = mesh->triangles[t];
        bool is_there = true;
        for (int k = 0; k < 3; k++)
            is_there &= fabs(mesh->positions[v[k]][2] - z) < 1e-9;
        for (int k = 0; is_there && k < 3; k++)
            areas[v[k]] +=
                pel_vec3_triangle_area(mesh->positions[v[0]], mesh->positions[v[1]], mesh->positions[v[2]]) / 3;
    }
}

static const double length = 1, width = 0.5, young = 1000, tension = 0.2;

/* a bar pinned at z = 0 and pulled at its end; returns how much longer it gets over what E A / L says */
static double pull_bar(int kind, pel_method method, int iterations)
{
    pel_mesh *mesh = make_block(width, width, length, 0.25);
    pel_body_def body = solid_body(mesh, kind, young, 0);
    int32_t *pinned = malloc((size_t)mesh->vertex_count * sizeof *pinned), end = -1;
    double *areas = malloc((size_t)mesh->vertex_count * sizeof *areas);
    body.pinned_count = 0;
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        if (mesh->positions[v][2] < 1e-9)
            pinned[body.pinned_count++] = v;
        if (mesh->positions[v][2] > length - 1e-9)
            end = v;
    }
    body.pinned = pinned;
    end_areas(mesh, length, areas);
    stage s = {.mesh = mesh, .model = make_model(&body)};
    pel_sim_def def = lone_sim(s.model, method, method == PEL_METHOD_EXPLICIT ? 0.002 : 0.05);
    pel_load_def load = pel_load_def_default();
    load.kind = PEL_LOAD_PER_VERTEX;
    load.force[2] = tension;
    load.weights = areas;
    def.loads = &load;
    def.load_count = 1;
    def.solver.drag = 3;
    def.solver.symplectic = method == PEL_METHOD_EXPLICIT;
    def.solver.iterations = iterations;
    s.sim = make_sim(&def);
    run_steps(s.sim, method == PEL_METHOD_STATIC ? 1 : (int)(10 / def.solver.dt));
    double *x = positions_of(&s);
    const double ratio = (x[3 * end + 2] - length) / (tension * length / young);
    free(x);
    free(pinned);
    free(areas);
    end_stage(&s);
    return ratio;
}

static void a_bar_stretches_by_its_stiffness(void **state)
{
    (void)state;
    static const pel_method methods[] = {PEL_METHOD_STATIC, PEL_METHOD_IMPLICIT, PEL_METHOD_XPBD, PEL_METHOD_EXPLICIT};
    for (int kind = 0; kind < PEL_VOLUME_COUNT; kind++)
        for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
            if (kind != PEL_VOLUME_NEO_HOOKEAN && m > 0 && !is_all())
                continue;
            /* nonlinear by 2e-4; xpbd is 1.2e-3 too stiff where a force acts on the few vertices of an end; float */
            const double most = methods[m] == PEL_METHOD_XPBD ? 2e-3 : 1e-3;
            assert_near(pull_bar(kind, methods[m], 0), 1, IN_FLOAT(most, 2e-2));
        }
    /* what one sweep has pulled is known to the next */
    assert_near(pull_bar(PEL_VOLUME_NEO_HOOKEAN, PEL_METHOD_XPBD, 4), 1, IN_FLOAT(1e-3, 2e-2));
}

/* momentum, angular momentum and centre of mass */
typedef struct motion {
    double momentum[3], spin[3], centre[3];
} motion;

static motion motion_of(const stage *s, const double *masses)
{
    double *x = positions_of(s), *v = malloc(3 * sizeof *v * (size_t)s->mesh->vertex_count), sum = 0;
    motion m = {{0}, {0}, {0}};
    pel_sim_get_velocities(s->sim, 0, v);
    for (int32_t i = 0; i < s->mesh->vertex_count; i++) {
        double arm[3];
        pel_vec3_cross(x + 3 * i, v + 3 * i, arm);
        pel_vec3_along(m.momentum, masses[i], v + 3 * i, m.momentum);
        pel_vec3_along(m.spin, masses[i], arm, m.spin);
        pel_vec3_along(m.centre, masses[i], x + 3 * i, m.centre);
        sum += masses[i];
    }
    pel_vec3_scale(m.centre, 1 / sum, m.centre);
    free(v);
    free(x);
    return m;
}

static double *masses_of(const pel_mesh *mesh)
{
    double *masses = calloc((size_t)mesh->vertex_count, sizeof *masses);
    for (int32_t t = 0; t < mesh->tetrahedron_count; t++) {
        double x[4][3];
        for (int k = 0; k < 4; k++)
            pel_vec3_copy(mesh->positions[mesh->tetrahedra[t][k]], x[k]);
        for (int k = 0; k < 4; k++)
            masses[mesh->tetrahedra[t][k]] += 250 * pel_tetrahedron_volume((const double(*)[3])x);
    }
    return masses;
}

/* squeezed, turning and flying, without anything that acts from outside */
static void bodies_keep_their_momentum(void **state)
{
    (void)state;
    static const pel_method methods[] = {PEL_METHOD_IMPLICIT, PEL_METHOD_XPBD, PEL_METHOD_EXPLICIT};
    for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
        pel_mesh *mesh = make_block(0.4, 0.5, 0.6, 0.2);
        pel_body_def body = solid_body(mesh, PEL_VOLUME_NEO_HOOKEAN, 2000, 0.3);
        pel_vec3_set(body.velocity, 1, -0.5, 0.2);
        pel_vec3_set(body.angular_velocity, 0.5, 2, 1);
        stage s = make_stage(mesh, &body, methods[m], methods[m] == PEL_METHOD_EXPLICIT ? 1e-3 : 0.01);
        double *x = positions_of(&s), *masses = masses_of(mesh);
        for (int32_t v = 0; v < mesh->vertex_count; v++)
            x[3 * v] *= 0.8;
        assert_int_equal(pel_sim_set_positions(s.sim, 0, x, NULL), PEL_OK);
        const motion before = motion_of(&s, masses);
        run_steps(s.sim, methods[m] == PEL_METHOD_EXPLICIT ? 200 : 20);
        const motion after = motion_of(&s, masses);
        /* the implicit one solves to a tolerance */
        const double tolerance = methods[m] == PEL_METHOD_IMPLICIT ? 1e-5 : IN_FLOAT(1e-9, 1e-3);
        const double mass = 1000 * 0.4 * 0.5 * 0.6;
        for (int k = 0; k < 3; k++) {
            assert_near(after.momentum[k], before.momentum[k], tolerance * mass);
            assert_near(after.centre[k], before.centre[k] + 0.2 * before.momentum[k] / mass, tolerance);
        }
        /* explicit velocities are half a step apart from the positions, and implicit steps lose a little */
        for (int k = 0; k < 3 && methods[m] == PEL_METHOD_XPBD; k++)
            assert_near(after.spin[k], before.spin[k], 1e-2 * mass);
        free(masses);
        free(x);
        end_stage(&s);
    }
}

static void bodies_fall_freely(void **state)
{
    (void)state;
    pel_mesh *mesh = make_block(0.4, 0.5, 0.6, 0.2);
    const pel_body_def body = solid_body(mesh, PEL_VOLUME_COROTATED, 2000, 0.3);
    pel_model_def model = pel_model_def_default();
    model.bodies = &body;
    model.body_count = 1;
    model.gravity[2] = -9.81;
    stage s = {.mesh = mesh};
    assert_int_equal(pel_model_create(&model, &s.model, NULL), PEL_OK);
    pel_sim_def def = lone_sim(s.model, PEL_METHOD_IMPLICIT, 0.01);
    s.sim = make_sim(&def);
    run_steps(s.sim, 30);
    pel_sim_measures measures;
    pel_sim_measure(s.sim, &measures);
    assert_near(measures.max_displacement, 0.5 * 9.81 * 0.09, 1e-5);
    assert_near(measures.elastic_energy, 0, 1e-8);
    end_stage(&s);
}

static int inverted_count(const stage *s)
{
    double *x = positions_of(s);
    int count = 0;
    for (int32_t t = 0; t < s->mesh->tetrahedron_count; t++) {
        double points[4][3];
        for (int k = 0; k < 4; k++)
            pel_vec3_copy(x + 3 * s->mesh->tetrahedra[t][k], points[k]);
        count += !(pel_tetrahedron_volume((const double(*)[3])points) > 0);
    }
    free(x);
    return count;
}

/* to a volume of 0.3 with many tetrahedra inside out, then released */
static void crushed_cubes_recover(void **state)
{
    (void)state;
    static const pel_method methods[] = {PEL_METHOD_IMPLICIT, PEL_METHOD_XPBD};
    static const int kinds[] = {PEL_VOLUME_NEO_HOOKEAN, PEL_VOLUME_COROTATED};
    for (int i = 0; i < 4; i++) {
        random_state random = {7};
        pel_mesh *mesh = make_block(1, 1, 1, 0.33);
        const pel_body_def body = solid_body(mesh, kinds[i / 2], 1e4, 0.3);
        stage s = {.mesh = mesh, .model = make_model(&body)};
        pel_sim_def def = lone_sim(s.model, methods[i % 2], 0.01);
        def.solver.drag = 5;
        s.sim = make_sim(&def);
        double *x = positions_of(&s);
        for (int32_t v = 0; v < mesh->vertex_count; v++)
            for (int k = 0; k < 3; k++)
                x[3 * v + k] = x[3 * v + k] * (k == 2 ? 0.3 : 1) + random_between(&random, -0.08, 0.08);
        assert_int_equal(pel_sim_set_positions(s.sim, 0, x, NULL), PEL_OK);
        assert_true(inverted_count(&s) > 10);
        run_steps(s.sim, 200);
        assert_int_equal(inverted_count(&s), 0);
        pel_sim_measures measures;
        pel_sim_measure(s.sim, &measures);
        assert_near(measures.volume_ratio, 1, 1e-2);
        free(x);
        end_stage(&s);
    }
}

/* thin tetrahedra and one sweep of few substeps: bodies that fall undeformed get no energy */
static void falling_plates_stay_at_rest(void **state)
{
    (void)state;
    for (int kind = 0; kind < PEL_VOLUME_COUNT; kind++) {
        pel_mesh *mesh = make_block(1, 1, 1, 0.1);
        for (int32_t v = 0; v < mesh->vertex_count; v++)
            mesh->positions[v][2] *= 0.1;
        pel_body_def body = solid_body(mesh, kind, 2e4, 0.3);
        pel_model_def model = pel_model_def_default();
        model.bodies = &body;
        model.body_count = 1;
        model.gravity[2] = -9.81;
        stage s = {.mesh = mesh};
        assert_int_equal(pel_model_create(&model, &s.model, NULL), PEL_OK);
        pel_sim_def def = lone_sim(s.model, PEL_METHOD_XPBD, 0.01);
        def.solver.substeps = 4;
        s.sim = make_sim(&def);
        run_steps(s.sim, 20);
        pel_sim_measures measures;
        pel_sim_measure(s.sim, &measures);
        assert_true(measures.elastic_energy < 1e-6 * measures.kinetic_energy);
        end_stage(&s);
    }
}

/* automatic substeps follow the tetrahedra: they grow as the root of the stiffness */
static void substeps_follow_the_stiffness(void **state)
{
    (void)state;
    const double moduli[] = {1e5, 4e5, 1e5}, ratios[] = {0, 0, 0.45};
    double counts[3];
    for (int i = 0; i < 3; i++) {
        pel_mesh *mesh = make_block(1, 1, 1, 0.1);
        const pel_body_def body = solid_body(mesh, PEL_VOLUME_NEO_HOOKEAN, moduli[i], ratios[i]);
        pel_model *model = make_model(&body);
        const pel_sim_def def = lone_sim(model, PEL_METHOD_XPBD, 0.1);
        int32_t count = 0;
        assert_int_equal(pel_sim_needed_substeps(&def, &count, NULL), PEL_OK);
        counts[i] = count;
        pel_model_destroy(model);
        pel_mesh_destroy(mesh);
    }
    assert_true(counts[0] > 30);
    assert_near(counts[1] / counts[0], 2, 0.05);
    /* by the root of 10 for tetrahedra with the same mobility in all directions, of a third of it for one direction */
    assert_true(counts[2] / counts[0] > 1.8 && counts[2] / counts[0] < 3.2);
}

static void threads_change_nothing(void **state)
{
    (void)state;
    static const pel_method methods[] = {PEL_METHOD_STATIC, PEL_METHOD_XPBD, PEL_METHOD_EXPLICIT};
    for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
        uint64_t hashes[2];
        for (int i = 0; i < 2; i++) {
            pel_mesh *mesh = make_block(1, 1, 1, 0.1);
            pel_body_def body = solid_body(mesh, PEL_VOLUME_NEO_HOOKEAN, 1e4, 0.3);
            static const int32_t pinned[] = {0, 1, 2, 3, 30, 31, 60};
            body.pinned = pinned;
            body.pinned_count = 7;
            stage s = {.mesh = mesh, .model = make_model(&body)};
            pel_sim_def def = lone_sim(s.model, methods[m], 1e-3);
            pel_load_def load = pel_load_def_default();
            load.force[0] = 20;
            def.loads = &load;
            def.load_count = 1;
            def.thread_count = i == 0 ? 1 : 3;
            s.sim = make_sim(&def);
            run_steps(s.sim, methods[m] == PEL_METHOD_STATIC ? 1 : 3);
            hashes[i] = pel_sim_hash(s.sim);
            end_stage(&s);
        }
        assert_true(hashes[0] == hashes[1]);
    }
}

/* deflection of the end of a cantilever under a gravity across it, times its area, and derivatives of that */
static double sag(pel_volume_element element, double factor, double gravity, pel_adjoint_material *by_material,
                  double by_gravity[3])
{
    pel_mesh *mesh = make_block(width, width, 2, 0.25);
    pel_body_def body = solid_body(mesh, PEL_VOLUME_NEO_HOOKEAN, 2e5 * factor, 0.4);
    body.volume.element = element;
    int32_t *pinned = malloc((size_t)mesh->vertex_count * sizeof *pinned);
    body.pinned_count = 0;
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        if (mesh->positions[v][2] < 1e-9)
            pinned[body.pinned_count++] = v;
    body.pinned = pinned;
    pel_model_def def = pel_model_def_default();
    def.bodies = &body;
    def.body_count = 1;
    def.gravity[0] = gravity;
    stage s = {.mesh = mesh};
    assert_int_equal(pel_model_create(&def, &s.model, NULL), PEL_OK);
    const pel_sim_def sim = lone_sim(s.model, PEL_METHOD_STATIC, 1);
    s.sim = make_sim(&sim);
    run_steps(s.sim, 1);
    double *x = positions_of(&s), *by_positions = calloc(3 * (size_t)mesh->vertex_count, sizeof *x);
    double *areas = malloc((size_t)mesh->vertex_count * sizeof *areas), sum = 0;
    end_areas(mesh, 2, areas);
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        by_positions[3 * v] = areas[v];
        sum += areas[v] * (x[3 * v] - mesh->positions[v][0]);
    }
    const pel_adjoint adjoint = {.positions = by_positions, .materials = by_material, .gravity = by_gravity};
    pel_error error;
    if (pel_sim_adjoint(s.sim, &adjoint, &error) != PEL_OK)
        fail_msg("%s", error.what);
    free(areas);
    free(by_positions);
    free(x);
    free(pinned);
    end_stage(&s);
    return sum;
}

/* by Young's modulus and gravity, against differences of whole solutions */
static void derivatives_are_those_of_equilibria(void **state)
{
    (void)state;
    for (int element = 0; element < PEL_VOLUME_ELEMENT_COUNT; element++) {
        pel_adjoint_material by_material, unused;
        double by_gravity[3], none[3];
        sag((pel_volume_element)element, 1, 1, &by_material, by_gravity);
        const double h = 1e-3, by_young = (sag((pel_volume_element)element, 1 + h, 1, &unused, none) -
                                           sag((pel_volume_element)element, 1 - h, 1, &unused, none)) /
                                          (2 * h);
        const double gravity = (sag((pel_volume_element)element, 1, 1 + h, &unused, none) -
                                sag((pel_volume_element)element, 1, 1 - h, &unused, none)) /
                               (2 * h);
        assert_true(fabs(by_young) > 1e-3);
        assert_near(by_material.volume, by_young, IN_FLOAT(1e-4, 1e-2) * fabs(by_young));
        assert_near(by_gravity[0], gravity, IN_FLOAT(1e-4, 1e-2) * fabs(gravity));
    }
}

/* ---- refusals ---- */

static void assert_refused(const pel_body_def *body, const char *words)
{
    pel_model_def def = pel_model_def_default();
    pel_model *model;
    pel_error error;
    def.bodies = body;
    def.body_count = 1;
    assert_int_equal(pel_model_create(&def, &model, &error), PEL_BAD_ARGUMENT);
    assert_null(model);
    if (strstr(error.what, words) == NULL)
        fail_msg("%s", error.what);
    assert_true(error.remedy[0] != '\0');
}

static void what_volumes_lack_is_refused(void **state)
{
    (void)state;
    pel_mesh *mesh = make_block(1, 1, 1, 0.5), *ball = make_sphere(2);
    pel_body_def body = solid_body(ball, PEL_VOLUME_STVK, 10, 0.3);
    assert_refused(&body, "tetrahedra");
    body = solid_body(mesh, PEL_VOLUME_COUNT, 10, 0.3);
    assert_refused(&body, "volume.kind");
    body = solid_body(mesh, PEL_VOLUME_STVK, 0, 0.3);
    assert_refused(&body, "volume.young");
    body = solid_body(mesh, PEL_VOLUME_STVK, 10, 0.5);
    assert_refused(&body, "volume.poisson");
    body = solid_body(mesh, PEL_VOLUME_MOONEY_RIVLIN, 10, 0.3);
    body.volume.mooney_ratio = -1;
    assert_refused(&body, "volume.mooney_ratio");
    body = solid_body(mesh, PEL_VOLUME_STVK, 10, 0.3);
    body.refine.levels = 1;
    assert_refused(&body, "refinement");
    body = solid_body(mesh, PEL_VOLUME_STVK, 10, 0.3);
    body.volumetric_stiffness.value = 1;
    assert_refused(&body, "volumetric springs");
    body = solid_body(mesh, PEL_VOLUME_STVK, 10, 0.3);
    body.fluid_density = 1000;
    assert_refused(&body, "liquid");
    body = solid_body(mesh, PEL_VOLUME_STVK, 10, 0.3);
    pel_model *model = make_model(&body);
    pel_sim_def def = lone_sim(model, PEL_METHOD_PBD, 0.01);
    check_refusal(&def, 0, "volume", NULL);
    /* derivatives by the shape at rest, and cuts */
    def = lone_sim(model, PEL_METHOD_STATIC, 0.01);
    pel_sim *sim = make_sim(&def);
    assert_int_equal(pel_sim_step(sim, NULL), PEL_OK);
    double *by_positions = calloc(6 * (size_t)pel_sim_vertex_count(sim, 0), sizeof *by_positions);
    const pel_adjoint adjoint = {.positions = by_positions,
                                 .rest_positions = by_positions + 3 * (size_t)pel_sim_vertex_count(sim, 0)};
    pel_error error;
    assert_int_equal(pel_sim_adjoint(sim, &adjoint, &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.what, "rest positions"));
    const int32_t *corners = mesh->triangles[0];
    assert_int_equal(pel_cut(sim, 0, corners, 2, &error), PEL_BAD_ARGUMENT);
    free(by_positions);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(ball);
    pel_mesh_destroy(mesh);
}

static pel_status model_case(const void *data, pel_error *error)
{
    const pel_body_def body = solid_body(data, PEL_VOLUME_COROTATED, 1000, 0.3);
    pel_model_def def = pel_model_def_default();
    pel_model *model;
    def.bodies = &body;
    def.body_count = 1;
    pel_status status = pel_model_create(&def, &model, error);
    if (status != PEL_OK) {
        assert_null(model);
        return status;
    }
    const pel_sim_def sim_def = lone_sim(model, PEL_METHOD_STATIC, 1);
    pel_sim *sim;
    status = pel_sim_create(&sim_def, &sim, error);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    return status;
}

static void memory_may_run_out(void **state)
{
    (void)state;
    pel_mesh *mesh = make_block(1, 1, 1, 1);
    assert_true(for_every_allocation_failure(model_case, mesh) > 20);
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(uniform_strain_is_exact),
        cmocka_unit_test(a_bar_stretches_by_its_stiffness),
        cmocka_unit_test(bodies_keep_their_momentum),
        cmocka_unit_test(bodies_fall_freely),
        cmocka_unit_test(crushed_cubes_recover),
        cmocka_unit_test(falling_plates_stay_at_rest),
        cmocka_unit_test(substeps_follow_the_stiffness),
        cmocka_unit_test(threads_change_nothing),
        cmocka_unit_test(derivatives_are_those_of_equilibria),
        cmocka_unit_test(what_volumes_lack_is_refused),
        cmocka_unit_test(memory_may_run_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
