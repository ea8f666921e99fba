# A core for any x86-64 machine that uses AVX2 where it runs: without PELLICLE_NATIVE all of it is compiled twice, and each
# public function jumps to the copy that the machine can take (cmake/entries.cmake). No source knows of it. Both copies
# give the same bits; PELLICLE_KERNELS=baseline in the environment takes the plain one.
if(PELLICLE_NATIVE OR NOT CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64)$" OR NOT CMAKE_OBJCOPY OR NOT CMAKE_NM
   OR PELLICLE_SANITIZE OR PELLICLE_COVERAGE)
    return()
endif()
add_library(pellicle_core_avx2 OBJECT ${PELLICLE_SOURCES})
target_include_directories(pellicle_core_avx2 PRIVATE include ${PELLICLE_ROOMS})
set_target_properties(pellicle_core_avx2 PROPERTIES C_VISIBILITY_PRESET hidden)
target_link_libraries(pellicle_core_avx2 PRIVATE pellicle_flags ZLIB::ZLIB Threads::Threads)
target_compile_options(pellicle_core_avx2 PRIVATE -mavx2)
if(PELLICLE_SINGLE)
    target_compile_definitions(pellicle_core_avx2 PRIVATE PEL_SINGLE)
endif()
# only the entries are public
foreach(copy pellicle_core pellicle_core_avx2)
    target_compile_definitions(${copy} PRIVATE PEL_API=)
endforeach()

set(KERNELS ${PROJECT_BINARY_DIR}/kernels)
file(MAKE_DIRECTORY ${KERNELS})
file(GLOB PUBLIC_HEADERS CONFIGURE_DEPENDS include/pellicle/*.h)
foreach(copy core core_avx2)
    # objects are listed in a file: the command line has a limit
    file(GENERATE OUTPUT ${KERNELS}/${copy}.list CONTENT "$<JOIN:$<TARGET_OBJECTS:pellicle_${copy}>,\n>\n")
    add_custom_command(OUTPUT ${KERNELS}/${copy}.o COMMAND ${CMAKE_C_COMPILER} -r -nostdlib -o ${KERNELS}/${copy}.o @${KERNELS}/${copy}.list
                       DEPENDS pellicle_${copy} $<TARGET_OBJECTS:pellicle_${copy}> VERBATIM)
endforeach()
add_custom_command(OUTPUT ${KERNELS}/baseline.o ${KERNELS}/avx2.o ${KERNELS}/entries.c
                   COMMAND ${CMAKE_COMMAND} -DNM=${CMAKE_NM} -DOBJCOPY=${CMAKE_OBJCOPY} -DFOLDER=${KERNELS}
                           -DHEADERS=${PROJECT_SOURCE_DIR}/include/pellicle -P ${PROJECT_SOURCE_DIR}/cmake/entries.cmake
                   DEPENDS ${KERNELS}/core.o ${KERNELS}/core_avx2.o ${PUBLIC_HEADERS} cmake/entries.cmake VERBATIM)
set_source_files_properties(${KERNELS}/baseline.o ${KERNELS}/avx2.o PROPERTIES EXTERNAL_OBJECT ON GENERATED ON)
add_library(pellicle_entries OBJECT ${KERNELS}/entries.c)
target_link_libraries(pellicle_entries PRIVATE pellicle_flags)
set(CORE_OBJECTS $<TARGET_OBJECTS:pellicle_entries> ${KERNELS}/baseline.o ${KERNELS}/avx2.o)
set(PELLICLE_TWO_KERNELS ON)
