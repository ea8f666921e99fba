# Flags for our own sources only: strict warnings, no contraction, never fast-math (same bits for gcc and clang).
add_library(pellicle_flags INTERFACE)
target_compile_options(pellicle_flags INTERFACE
    $<$<COMPILE_LANGUAGE:C>:-Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion -Wdouble-promotion
    -Wmissing-prototypes -Wstrict-prototypes -Wno-psabi>
    -ffp-contract=off -fno-math-errno -fno-trapping-math)
target_compile_definitions(pellicle_flags INTERFACE _POSIX_C_SOURCE=200809L)
if(PELLICLE_STRICT)
    target_compile_options(pellicle_flags INTERFACE -Werror)
endif()
if(PELLICLE_NATIVE AND EXISTS /proc/cpuinfo)
    file(STRINGS /proc/cpuinfo PELLICLE_HAS_AVX2 REGEX "^flags.* avx2( |$)" LIMIT_COUNT 1)
    if(PELLICLE_HAS_AVX2)
        target_compile_options(pellicle_flags INTERFACE -mavx2)
    endif()
endif()
if(PELLICLE_SANITIZE)
    add_compile_options(-fsanitize=${PELLICLE_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
    add_link_options(-fsanitize=${PELLICLE_SANITIZE})
endif()
if(PELLICLE_COVERAGE)
    add_compile_options(--coverage)
    add_link_options(--coverage)
endif()
