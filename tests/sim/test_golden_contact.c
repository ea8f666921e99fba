/* Golden hashes with contact and with refinement: sim/golden.h. */
#include "sim/golden.h"

static const golden_case cases[] = {
    {.solver = {.method = PEL_METHOD_XPBD, .dt = 0.01, .substeps = 8},
     .early = UINT64_C(0x6c5be7d9807b983b),
     .hash = UINT64_C(0x040a05094f37128e),
     .shell = true,
     .contact = true},
    {.solver = {.method = PEL_METHOD_XPBD, .dt = 0.01, .substeps = 8},
     .early = UINT64_C(0xc7fd4b2a5a329c41),
     .hash = UINT64_C(0xe28d5fa5fc1a068d),
     .refines = true},
    {.solver = {.method = PEL_METHOD_QUASI_STATIC, .dt = 0.01},
     .early = UINT64_C(0x9f132979f234245a),
     .hash = UINT64_C(0x9d21f4f31ef335ef),
     .refines = true},
    {.solver = {.method = PEL_METHOD_DESCENT, .dt = 0.05, .iterations = 20},
     .early = UINT64_C(0xcb5ef94cd8fe834a),
     .hash = UINT64_C(0xce63430d2c27c374),
     .shell = true,
     .contact = true},
    {.solver = {.method = PEL_METHOD_IMPLICIT, .dt = 0.1},
     .early = UINT64_C(0x9457c17f47d2b594),
     .hash = UINT64_C(0xac723e9ad026a03e),
     .shell = true,
     .contact = true},
    {.solver = {.method = PEL_METHOD_IMPLICIT, .dt = 0.1},
     .early = UINT64_C(0xdba0541dbc09868b),
     .hash = UINT64_C(0x394368fd58f2db09),
     .refines = true},
    {.solver = {.method = PEL_METHOD_XPBD, .dt = 0.01, .substeps = 8},
     .early = UINT64_C(0x573fdee216f06006),
     .hash = UINT64_C(0xf59734f1ea1c6cd4),
     .refines = true,
     .shell = true,
     .contact = true},
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
