# Tests of the house itself: layers, text, format, headers, compiler flags, install.
set(HOUSE ${CMAKE_CURRENT_SOURCE_DIR}/house)
enable_language(CXX)

add_test(NAME house/layers COMMAND ${PYTHON3} ${HOUSE}/layers.py ${PROJECT_SOURCE_DIR})
add_test(NAME house/layers_self_test COMMAND ${PYTHON3} ${HOUSE}/layers.py --self-test ${PROJECT_SOURCE_DIR})
add_test(NAME house/links COMMAND ${PYTHON3} ${HOUSE}/links.py ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR} ${CMAKE_NM})
add_test(NAME house/links_self_test COMMAND ${PYTHON3} ${HOUSE}/links.py --self-test)
add_test(NAME house/methods COMMAND ${PYTHON3} ${HOUSE}/methods.py ${PROJECT_SOURCE_DIR})
add_test(NAME house/methods_self_test COMMAND ${PYTHON3} ${HOUSE}/methods.py --self-test)
add_test(NAME house/mutants COMMAND ${PYTHON3} ${HOUSE}/mutants.py ${PROJECT_SOURCE_DIR})
add_test(NAME house/mutants_self_test COMMAND ${PYTHON3} ${HOUSE}/mutants.py --self-test)
add_test(NAME house/drawing COMMAND ${PYTHON3} ${PROJECT_SOURCE_DIR}/tools/house --check)
add_test(NAME house/functions COMMAND ${PYTHON3} ${HOUSE}/functions.py ${PROJECT_SOURCE_DIR})
add_test(NAME house/summary_self_test COMMAND ${PYTHON3} ${PROJECT_SOURCE_DIR}/tools/test-summary --self-test)
add_test(NAME house/functions_self_test COMMAND ${PYTHON3} ${HOUSE}/functions.py --self-test)
add_test(NAME house/text COMMAND ${PYTHON3} ${HOUSE}/text.py ${PROJECT_SOURCE_DIR})
add_test(NAME house/allocations COMMAND ${PYTHON3} ${HOUSE}/allocations.py ${PROJECT_SOURCE_DIR})
add_test(NAME house/misuse COMMAND ${PYTHON3} ${HOUSE}/misuse.py ${PROJECT_SOURCE_DIR})
add_test(NAME house/fingerprint COMMAND ${PYTHON3} ${HOUSE}/fingerprint.py ${PROJECT_SOURCE_DIR})
add_test(NAME house/flags COMMAND ${PYTHON3} ${HOUSE}/flags.py ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR})
if(TARGET pellicle_shared AND NOT PELLICLE_COVERAGE)
    add_test(NAME house/exports COMMAND ${PYTHON3} ${HOUSE}/exports.py ${PROJECT_SOURCE_DIR} $<TARGET_FILE:pellicle_shared>
                                        $<TARGET_FILE:pellicle> ${CMAKE_NM})
endif()

# clang-format 14 is pinned: other versions format differently
find_program(CLANG_FORMAT clang-format-14 REQUIRED)
file(GLOB_RECURSE FORMATTED CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/*.[ch] ${PROJECT_SOURCE_DIR}/cli/*.[ch]
     ${PROJECT_SOURCE_DIR}/papers/*.[ch] ${PROJECT_SOURCE_DIR}/view/*.[ch]
     ${PROJECT_SOURCE_DIR}/include/*.h ${PROJECT_SOURCE_DIR}/tests/*.[ch] ${PROJECT_SOURCE_DIR}/tests/*.cpp
     ${PROJECT_SOURCE_DIR}/bench/*.[ch] ${PROJECT_SOURCE_DIR}/examples/*.[ch] ${PROJECT_SOURCE_DIR}/python/*.[ch])
set(FORMATTED_TESTS ${FORMATTED})
list(FILTER FORMATTED EXCLUDE REGEX "^${PROJECT_SOURCE_DIR}/tests/")
list(FILTER FORMATTED_TESTS INCLUDE REGEX "^${PROJECT_SOURCE_DIR}/tests/")
add_test(NAME house/format COMMAND ${CLANG_FORMAT} --dry-run -Werror ${FORMATTED})
add_test(NAME house/format_tests COMMAND ${CLANG_FORMAT} --dry-run -Werror ${FORMATTED_TESTS})

# each public header compiles alone, in C99 and in C++17
file(GLOB HEADERS CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR}/include/pellicle ${PROJECT_SOURCE_DIR}/include/pellicle/*.h)
set(HEADER_FLAGS -Wall -Wextra -Wpedantic -Werror -fsyntax-only -I ${PROJECT_SOURCE_DIR}/include)
foreach(header ${HEADERS})
    set(alone ${CMAKE_CURRENT_BINARY_DIR}/alone/${header}.c)
    file(CONFIGURE OUTPUT ${alone} CONTENT "#include <pellicle/@header@>\n#include <pellicle/@header@>\nint nothing;\n")
    add_test(NAME header/${header}_c99 COMMAND ${CMAKE_C_COMPILER} -std=c99 ${HEADER_FLAGS} ${alone})
    add_test(NAME header/${header}_c++17 COMMAND ${CMAKE_CXX_COMPILER} -std=c++17 ${HEADER_FLAGS} -x c++ ${alone})
endforeach()

# the installed library from outside; a sanitized or instrumented archive needs flags that outsiders do not have
if(NOT PELLICLE_SANITIZE AND NOT PELLICLE_COVERAGE)
    add_test(NAME house/install COMMAND bash ${HOUSE}/install.sh ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR}
                                        ${CMAKE_C_COMPILER} ${CMAKE_CXX_COMPILER})
endif()

# the tag of a wheel
if(CMAKE_SYSTEM_NAME STREQUAL "Linux" AND NOT PELLICLE_SANITIZE)
    add_test(NAME house/audit COMMAND bash ${HOUSE}/audit.sh ${PROJECT_SOURCE_DIR} ${CMAKE_C_COMPILER})
endif()

# what macOS lacks is found; sources of libfyaml and zlib come from the network once, or with `make wasm` and `make machines`
if(NOT PELLICLE_SANITIZE AND EXISTS ${PROJECT_SOURCE_DIR}/build/sources/libfyaml)
    add_test(NAME house/macos COMMAND bash ${HOUSE}/macos.sh ${PROJECT_SOURCE_DIR})
endif()

# links and commands of the pages
if(TARGET pellicle_program)
    add_test(NAME house/docs COMMAND ${PYTHON3} ${HOUSE}/docs.py ${PROJECT_SOURCE_DIR} $<TARGET_FILE:pellicle_program>)
    add_test(NAME house/demo COMMAND bash ${HOUSE}/demo.sh ${PROJECT_SOURCE_DIR} $<TARGET_FILE:pellicle_program>)
    # the commands of the pages; films need ffmpeg, reports the page that `make web` builds
    find_program(FFMPEG ffmpeg)
    set(COMMANDS_DRAW $<$<AND:$<BOOL:${PELLICLE_VIEW}>,$<BOOL:${FFMPEG}>>:render>)
    add_test(NAME house/commands COMMAND ${PYTHON3} ${HOUSE}/commands.py ${PROJECT_SOURCE_DIR}
                                         $<TARGET_FILE:pellicle_program> ${COMMANDS_DRAW})
endif()

# docs/reference is what the program says (make docs writes it)
if(TARGET pellicle_program)
    add_test(NAME house/reference COMMAND bash -c "\
        '$<TARGET_FILE:pellicle_program>' reference | diff '${PROJECT_SOURCE_DIR}/docs/reference/scene.md' - && \
        '$<TARGET_FILE:pellicle_program>' schema | diff '${PROJECT_SOURCE_DIR}/docs/reference/scene.schema.json' - || \
        { echo 'docs/reference is not current: run make docs'; exit 1; }")
endif()
