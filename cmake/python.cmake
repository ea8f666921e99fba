# The Python package: the extension module pellicle._core beside python/pellicle/*.py in the folder python/pellicle of the
# build, so that PYTHONPATH=build/release/python is enough to try it. setup.py builds the target pellicle_python.
if(NOT PELLICLE_PROGRAM)
    return()
endif()
set(PELLICLE_PYTHON auto CACHE STRING "Python package: ON, OFF, or auto where a Python 3.11 with headers is installed")
if(NOT PELLICLE_PYTHON)
    return()
endif()
find_program(PELLICLE_PYTHON_PROGRAM NAMES python3 PATHS /usr/bin NO_DEFAULT_PATH DOC "Python that the package is built for")
find_program(PELLICLE_PYTHON_PROGRAM NAMES python3 DOC "Python that the package is built for")
execute_process(COMMAND ${PELLICLE_PYTHON_PROGRAM} -c
    "import sys, sysconfig; print(sysconfig.get_path('include') if sys.version_info >= (3, 11) else '')"
    OUTPUT_VARIABLE PYTHON_INCLUDE OUTPUT_STRIP_TRAILING_WHITESPACE)
if(NOT PYTHON_INCLUDE OR NOT EXISTS ${PYTHON_INCLUDE}/Python.h)
    if(NOT PELLICLE_PYTHON STREQUAL "auto")
        message(FATAL_ERROR "the Python package needs Python 3.11 or later with its headers: install python3-dev")
    endif()
    return()
endif()

file(GLOB PYTHON_SOURCES CONFIGURE_DEPENDS python/core/*.c)
# slots of types hold functions as void *
set_source_files_properties(${PYTHON_SOURCES} PROPERTIES COMPILE_OPTIONS -Wno-pedantic)
add_library(pellicle_python MODULE ${PYTHON_SOURCES})
set_target_properties(pellicle_python PROPERTIES PREFIX "" OUTPUT_NAME _core SUFFIX .abi3.so C_VISIBILITY_PRESET hidden
                      LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/python/pellicle)
target_compile_definitions(pellicle_python PRIVATE Py_LIMITED_API=0x030B0000)
target_include_directories(pellicle_python SYSTEM PRIVATE ${PYTHON_INCLUDE})
# only PyInit__core is to be seen from outside
target_link_options(pellicle_python PRIVATE -Wl,--exclude-libs,ALL)
target_link_libraries(pellicle_python PRIVATE pellicle_flags pellicle_scene)

file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/python/pellicle)
file(GLOB PYTHON_MODULES CONFIGURE_DEPENDS python/pellicle/*)
foreach(module ${PYTHON_MODULES})
    get_filename_component(name ${module} NAME)
    if(NOT IS_DIRECTORY ${module})
        file(CREATE_LINK ${module} ${PROJECT_BINARY_DIR}/python/pellicle/${name} SYMBOLIC)
    endif()
endforeach()
