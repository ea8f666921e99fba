/* Golden hashes with contact and with refinement: sim/golden.h. */
#include "sim/golden.h"

static const golden_case cases[] = {
    {.solver = {.method = PEL_METHOD_XPBD, .dt = 0.01, .substeps = 8},
     .early = UINT64_C(0x63f120b6aff9c99f),
     .hash = UINT64_C(0x483857ad9b957877),
     .shell = true,
     .contact = true},
    {.solver = {.method = PEL_METHOD_XPBD, .dt = 0.01, .substeps = 8},
     .early = UINT64_C(0xec56e27bd73d0afa),
     .hash = UINT64_C(0x20a908e527c4f07b),
     .refines = true},
    {.solver = {.method = PEL_METHOD_QUASI_STATIC, .dt = 0.01},
     .early = UINT64_C(0x9f132979f234245a),
     .hash = UINT64_C(0x9d21f4f31ef335ef),
     .refines = true},
    {.solver = {.method = PEL_METHOD_DESCENT, .dt = 0.05, .iterations = 20},
     .early = UINT64_C(0xfde5cecf81908484),
     .hash = UINT64_C(0x5a7f74090d5868de),
     .shell = true,
     .contact = true},
    {.solver = {.method = PEL_METHOD_IMPLICIT, .dt = 0.1},
     .early = UINT64_C(0xcaa22ad71f8fdc15),
     .hash = UINT64_C(0x240b7368c43b3bbc),
     .shell = true,
     .contact = true},
    {.solver = {.method = PEL_METHOD_IMPLICIT, .dt = 0.1},
     .early = UINT64_C(0x6febe9c9663b17ca),
     .hash = UINT64_C(0xce519c7785dbbfc6),
     .refines = true},
    {.solver = {.method = PEL_METHOD_XPBD, .dt = 0.01, .substeps = 8},
     .early = UINT64_C(0x7826bd9fb0bf5baf),
     .hash = UINT64_C(0xdfeb2181d9aa0058),
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
