/* Defs of simulations that are refused, each with its defect. */
#include "base/pool.h"
#include "model/model.h"
#include "pellicle/mesh.h"
#include "pellicle/model.h"
#include "sim/fixture.h"

typedef enum fault {
    FAULT_NONE,
    NO_COOKIE,
    NO_MODEL,
    DT_NONE,
    DT_ENDLESS,
    ALPHA_BELOW,
    METHOD_UNKNOWN,
    ANALYSIS_OF_STEPS,
    ITERATIONS_BELOW,
    SUBSTEPS_MANY,
    SECOND_ORDER_UNKNOWN,
    BUDGET_BELOW,
    BUDGET_ENDLESS,
    BUDGET_OF_SWEEPS,
    DRAG_BELOW,
    DRAG_NAN,
    THREADS_BELOW,
    THREADS_MANY,
    LOADS_BELOW,
    LOADS_NULL,
    TOOLS_NULL,
    SUPPORTS_NULL,
    FAULT_COUNT
} fault;

static const char *const messages[FAULT_COUNT] = {
    [NO_COOKIE] = "pel_sim_def_default",
    [NO_MODEL] = "no model",
    [DT_NONE] = "dt is 0",
    [DT_ENDLESS] = "dt is inf",
    [ALPHA_BELOW] = "alpha is -1",
    [METHOD_UNKNOWN] = "method 99",
    [ANALYSIS_OF_STEPS] = "only the method static has an analysis",
    [ITERATIONS_BELOW] = "iterations is -1",
    [SUBSTEPS_MANY] = "substeps is 1000001",
    [SECOND_ORDER_UNKNOWN] = "second_order is 7",
    [BUDGET_BELOW] = "budget is -1",
    [BUDGET_ENDLESS] = "budget is inf",
    [BUDGET_OF_SWEEPS] = "have a budget of time",
    [DRAG_BELOW] = "drag is -1",
    [DRAG_NAN] = "drag is nan",
    [THREADS_BELOW] = "thread_count is -1",
    [THREADS_MANY] = "thread_count is 1025",
    [LOADS_BELOW] = "load_count is -1",
    [LOADS_NULL] = "loads is null",
    [TOOLS_NULL] = "tools is null",
    [SUPPORTS_NULL] = "supports is null",
};

static void break_solver(fault what, pel_solver_def *solver)
{
    switch (what) {
    case DT_NONE:
        solver->dt = 0;
        break;
    case DT_ENDLESS:
        solver->dt = (double)INFINITY;
        break;
    case ALPHA_BELOW:
        solver->alpha = -1;
        break;
    case METHOD_UNKNOWN:
        solver->method = (pel_method)99;
        break;
    case ANALYSIS_OF_STEPS:
        solver->method = PEL_METHOD_IMPLICIT;
        solver->analysis = PEL_ANALYSIS_MODAL;
        break;
    case ITERATIONS_BELOW:
        solver->iterations = -1;
        break;
    case SUBSTEPS_MANY:
        solver->substeps = 1000001;
        break;
    case SECOND_ORDER_UNKNOWN:
        solver->second_order = (pel_choice)7;
        break;
    case BUDGET_BELOW:
        solver->method = PEL_METHOD_IMPLICIT;
        solver->budget = -1;
        break;
    case BUDGET_ENDLESS:
        solver->method = PEL_METHOD_IMPLICIT;
        solver->budget = (double)INFINITY;
        break;
    case BUDGET_OF_SWEEPS:
        solver->method = PEL_METHOD_XPBD;
        solver->budget = 1;
        break;
    case DRAG_BELOW:
        solver->drag = -1;
        break;
    case DRAG_NAN:
        solver->drag = (double)NAN;
        break;
    default:
        break;
    }
}

static void break_def(fault what, pel_sim_def *def)
{
    switch (what) {
    case NO_COOKIE:
        def->cookie ^= 1;
        break;
    case NO_MODEL:
        def->model = NULL;
        break;
    case THREADS_BELOW:
        def->thread_count = -1;
        break;
    case THREADS_MANY:
        def->thread_count = PEL_THREADS_MOST + 1;
        break;
    case LOADS_BELOW:
        def->load_count = -1;
        break;
    case LOADS_NULL:
        def->load_count = 1;
        break;
    case TOOLS_NULL:
        def->tool_count = 1;
        break;
    case SUPPORTS_NULL:
        def->support_count = 1;
        break;
    default:
        break_solver(what, &def->solver);
    }
}

static void test_refusals(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(3);
    pel_body_def body = ball_body(mesh);
    pel_model *model = make_model(&body);
    for (int f = FAULT_NONE; f < FAULT_COUNT; f++) {
        pel_sim_def def = pel_sim_def_default();
        def.model = model;
        break_def((fault)f, &def);
        check_refusal(&def, f, messages[f], NULL);
    }
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_refusals)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
