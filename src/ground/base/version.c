#include "pellicle/base.h"

const char *pel_version(void)
{
    return PEL_VERSION;
}

const char *pel_kernels(void)
{
#ifdef __AVX2__
    return "avx2";
#else
    return "baseline";
#endif
}
