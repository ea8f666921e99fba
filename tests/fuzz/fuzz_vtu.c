#include "fuzz_filled.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_parse_filled("fuzz.vtu", data, size);
    return 0;
}
