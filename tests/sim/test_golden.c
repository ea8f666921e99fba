/* Golden hashes of the methods alone: sim/golden.h. */
#include "sim/golden.h"

static const golden_case cases[] = {
    {.solver = {.method = PEL_METHOD_QUASI_STATIC, .dt = 0.01, .alpha = 50},
     .early = UINT64_C(0x3f432437b66082f8),
     .hash = UINT64_C(0x584d1616326a71eb)},
    {.solver = {.method = PEL_METHOD_QUASI_STATIC, .dt = 0.01, .alpha = 15, .keep_velocity = true},
     .early = UINT64_C(0x81b231283e874d9d),
     .hash = UINT64_C(0xff8feeb56245ef52)},
    {.solver = {.method = PEL_METHOD_EXPLICIT, .dt = 0.001},
     .early = UINT64_C(0x2f8562ad610eb2f3),
     .hash = UINT64_C(0x2ad4a6aa91c415e3)},
    {.solver = {.method = PEL_METHOD_EXPLICIT, .dt = 0.01, .symplectic = true},
     .early = UINT64_C(0xd858e236a65ab1c6),
     .hash = UINT64_C(0x8007de2faa225060)},
    {.solver = {.method = PEL_METHOD_PBD, .dt = 0.01},
     .early = UINT64_C(0x7e54a78b54b3d5b2),
     .hash = UINT64_C(0x1c86d257a482a7ed),
     .shell = true},
    {.solver = {.method = PEL_METHOD_XPBD, .dt = 0.01, .substeps = 8},
     .early = UINT64_C(0x7427f1ac1b0e8ee5),
     .hash = UINT64_C(0xc36cf8128f189fe9),
     .shell = true},
    {.solver = {.method = PEL_METHOD_XPBD, .dt = 0.01, .substeps = 8},
     .early = UINT64_C(0x3619075cb3f6f00d),
     .hash = UINT64_C(0x0be4782e4164e20f),
     .shell = true,
     .law = PEL_MEMBRANE_NEO_HOOKEAN},
    {.solver = {.method = PEL_METHOD_XPBD, .dt = 0.01, .substeps = 4, .second_order = PEL_YES},
     .early = UINT64_C(0xe1ce6d3696d3a726),
     .hash = UINT64_C(0x76af88829ae6aca6),
     .shell = true},
    {.solver = {.method = PEL_METHOD_DESCENT, .dt = 0.05, .iterations = 20},
     .early = UINT64_C(0x6e77c6b18f514ac8),
     .hash = UINT64_C(0xf27c0a1246af8555),
     .shell = true},
    {.solver = {.method = PEL_METHOD_IMPLICIT, .dt = 0.1},
     .early = UINT64_C(0x5d3ef7d9f6f07f53),
     .hash = UINT64_C(0xcd984976865c192e),
     .shell = true},
    {.solver = {.method = PEL_METHOD_STATIC, .dt = 0.25},
     .early = UINT64_C(0x7dafc1630f6da542),
     .hash = UINT64_C(0x0641ce74cd56e71f),
     .shell = true},
};

static void test_hashes(void **unused)
{
    (void)unused;
    check_cases(cases, sizeof cases / sizeof *cases);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_hashes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
