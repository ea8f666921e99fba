cmake_policy(VERSION 3.21)
# Renames the symbols of both copies of the core and writes the entries that choose between them.
#   core.o       -> baseline.o: public functions get the ending _baseline; inner ones keep their names, for the scene library
#   core_avx2.o  -> avx2.o: all symbols get the ending _avx2
#   entries.c    : each public function is a jump through a table, which is set once, before main
# usage: cmake -DNM= -DOBJCOPY= -DFOLDER= -DHEADERS= -P entries.cmake

# name of the global symbols that an object defines
function(read_symbols object result)
    execute_process(COMMAND ${NM} -g --defined-only ${object} OUTPUT_VARIABLE text COMMAND_ERROR_IS_FATAL ANY)
    string(REGEX MATCHALL " [A-Za-z] [^\n]+" lines "${text}")
    list(TRANSFORM lines REPLACE "^ . " "")
    set(${result} ${lines} PARENT_SCOPE)
endfunction()

# renames symbols of an object: each name gets the ending
function(rename object ending names result)
    list(TRANSFORM names REPLACE "(.+)" "\\1 \\1${ending}")
    list(JOIN names "\n" text)
    file(WRITE ${FOLDER}/names${ending} "${text}\n")
    execute_process(COMMAND ${OBJCOPY} --redefine-syms=${FOLDER}/names${ending} ${object} ${result} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

set(declared)
file(GLOB headers ${HEADERS}/*.h)
foreach(header ${headers})
    file(READ ${header} text)
    string(REGEX MATCHALL "PEL_API [^;(]*pel_[a-z0-9_]+\\(" found "${text}")
    list(TRANSFORM found REPLACE ".*[ *\n](pel_[a-z0-9_]+)\\($" "\\1")
    list(APPEND declared ${found})
endforeach()
read_symbols(${FOLDER}/core.o defined)
read_symbols(${FOLDER}/core_avx2.o all)
set(public)
foreach(name ${declared})
    if(name IN_LIST defined)
        list(APPEND public ${name})
    endif()
endforeach()
list(SORT public)
rename(${FOLDER}/core.o _baseline "${public}" ${FOLDER}/baseline.o)
rename(${FOLDER}/core_avx2.o _avx2 "${all}" ${FOLDER}/avx2.o)

set(entries)
set(number 0)
foreach(name ${public})
    list(APPEND entries "    X(${name}, ${number})")
    math(EXPR number "${number} + 1")
endforeach()
list(JOIN entries " \\\n" entries)
file(CONFIGURE OUTPUT ${FOLDER}/entries.c @ONLY CONTENT [[/* Made by cmake/entries.cmake: jumps from public functions to their copies for the machine. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define PUBLIC(X) \
@entries@

typedef void pel_entry(void);
#define DECLARE(name, number) extern pel_entry name##_baseline, name##_avx2;
PUBLIC(DECLARE)

/* (functions) the copies in use; the plain ones until choose_kernels has run */
#define BASELINE(name, number) name##_baseline,
extern pel_entry *pel_entries[];
__attribute__((visibility("hidden"))) pel_entry *pel_entries[] = {PUBLIC(BASELINE)};

#define AVX2(name, number) name##_avx2,
static pel_entry *const avx2_entries[] = {PUBLIC(AVX2)};

__attribute__((constructor(101))) static void choose_kernels(void)
{
    const char *wanted = getenv("PELLICLE_KERNELS");
    __builtin_cpu_init();
    if (__builtin_cpu_supports("avx2") && (wanted == NULL || strcmp(wanted, "baseline") != 0))
        memcpy(pel_entries, avx2_entries, sizeof avx2_entries);
}

/* touches no register that carries an argument */
#define ENTRY(name, number) \
    __asm__(".text\n.p2align 4\n.globl " #name "\n.type " #name ", @function\n" #name ":\n\tendbr64\n" \
            "\tjmp *pel_entries+8*" #number "(%rip)\n.size " #name ", .-" #name "\n");
PUBLIC(ENTRY)
]])
