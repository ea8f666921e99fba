/* Contact that nothing touches: what swings goes on as without it. */
#include "math/vec3.h"
#include "sim/contact_scene.h"
#include "sim/descent_fixture.h"

/* where an oval shell is after 12 steps, with a contact section or without */
static void swing(pel_method method, const pel_contact_def *contact, double x[3 * 100])
{
    stage s;
    pel_body_def body;
    pel_sim_def def;
    double speeds[3 * 100];
    s.mesh = make_sphere(2);
    body = pel_body_def_sheet("shell", s.mesh, 1e4, 0.1, 1000);
    body.shell.membrane.kind = PEL_MEMBRANE_STVK;
    body.shell.bending.model = PEL_BENDING_HINGE;
    s.model = make_model(&body);
    def = lone_sim(s.model, method, method == PEL_METHOD_EXPLICIT ? 0.001 : 0.02);
    if (contact != NULL)
        def.contact = *contact;
    s.sim = make_sim(&def);
    for (int32_t v = 0; v < s.mesh->vertex_count; v++) {
        const double *at = s.mesh->positions[v];
        pel_vec3_set(speeds + 3 * (size_t)v, 0.3 * at[0] + 0.1, -0.3 * at[1], 0.09 * at[0]);
    }
    assert_int_equal(pel_sim_set_velocities(s.sim, 0, speeds, NULL), PEL_OK);
    run_steps(s.sim, 12);
    pel_sim_get_positions(s.sim, 0, x);
    end_stage(&s);
}

/* contact that nothing can touch changes no bit of any method */
static void test_idle_contact(void **unused)
{
    (void)unused;
    double alone[3 * 100] = {0}, beside[3 * 100] = {0};
    pel_contact_def contact = pel_sim_def_default().contact;
    contact.enabled = true;
    contact.self = false;
    for (int m = 0; m < 3; m++) {
        const pel_method method = (pel_method[]){PEL_METHOD_XPBD, PEL_METHOD_EXPLICIT, PEL_METHOD_IMPLICIT}[m];
        swing(method, NULL, alone);
        swing(method, &contact, beside);
        assert_memory_equal(alone, beside, sizeof alone);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_idle_contact)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
