# The command line: each tests/cli/cases/NAME.txt is the test cli/NAME.
if(TARGET pellicle_program)
    file(GLOB CLI_CASES CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/cli/cases/*.txt)
    foreach(path ${CLI_CASES})
        get_filename_component(name ${path} NAME_WE)
        if((name MATCHES "^render" AND NOT TARGET pellicle_view) OR (name STREQUAL "live" AND NOT TARGET pellicle_live))
            continue()
        endif()
        add_test(NAME cli/${name} COMMAND ${PYTHON3} ${CMAKE_CURRENT_SOURCE_DIR}/cli/run_case.py
                                          $<TARGET_FILE:pellicle_program> ${path})
    endforeach()
    # frames before VTK, as ParaView reads them; skipped without Debian's python3-vtk9
    add_test(NAME cli/vtk_frames COMMAND ${PYTHON3} ${CMAKE_CURRENT_SOURCE_DIR}/io/vtk_frames.py
                                         $<TARGET_FILE:pellicle_program>)
    # what VTK writes, in every encoding
    add_test(NAME cli/vtk_formats COMMAND ${PYTHON3} ${CMAKE_CURRENT_SOURCE_DIR}/io/vtk_formats.py
                                          $<TARGET_FILE:pellicle_program>)
    set_tests_properties(cli/vtk_frames cli/vtk_formats PROPERTIES SKIP_RETURN_CODE 77)
    # killed, hung up, out of disk or memory, not alone, led astray
    add_test(NAME cli/faults COMMAND ${PYTHON3} ${CMAKE_CURRENT_SOURCE_DIR}/cli/faults.py
                                     $<TARGET_FILE:pellicle_program>)
    set_tests_properties(cli/faults PROPERTIES ENVIRONMENT "PELLICLE_SANITIZE=${PELLICLE_SANITIZE};LSAN_OPTIONS=detect_leaks=0")
    # live as a process: signals, answers, a session that was killed
    if(TARGET pellicle_live AND NOT PELLICLE_SANITIZE)
        add_test(NAME cli/live_process COMMAND ${PYTHON3} ${CMAKE_CURRENT_SOURCE_DIR}/cli/live_process.py $<TARGET_FILE:pellicle_program>)
    endif()
    # what a power failure may leave; the recorder is preloaded, which sanitizers do not bear
    if(NOT PELLICLE_SANITIZE AND CMAKE_SYSTEM_NAME STREQUAL "Linux")
        add_test(NAME cli/power COMMAND ${PYTHON3} ${CMAKE_CURRENT_SOURCE_DIR}/cli/power.py $<TARGET_FILE:pellicle_program>)
    endif()
    # things that are pressed together, by `make nightly` or with PELLICLE_ALL
    add_test(NAME cli/pressed COMMAND ${PYTHON3} ${CMAKE_CURRENT_SOURCE_DIR}/cli/pressed.py
                                      $<TARGET_FILE:pellicle_program>)
    set_tests_properties(cli/pressed PROPERTIES SKIP_RETURN_CODE 77)
    # whole runs of random scenes: more of them by `make nightly`
    set(PROPERTIES --count 12)
    if(PELLICLE_SANITIZE)
        set(PROPERTIES --count 8 --sanitized)
    endif()
    if(PELLICLE_SINGLE)
        set(PROPERTIES --count 16 --single)
    endif()
    add_test(NAME cli/properties COMMAND ${PYTHON3} ${CMAKE_CURRENT_SOURCE_DIR}/cli/properties.py
                                         $<TARGET_FILE:pellicle_program> ${PROPERTIES} --keep ${PROJECT_BINARY_DIR}/broken)
    set_tests_properties(cli/properties PROPERTIES ENVIRONMENT "${SANITIZER_OPTIONS};LSAN_OPTIONS=detect_leaks=0" PROCESSORS 2)
    # a job array on a real Slurm; skipped unless PELLICLE_TEST_SLURM=1 and Slurm and munge are installed
    add_test(NAME cli/slurm COMMAND ${PYTHON3} ${CMAKE_CURRENT_SOURCE_DIR}/cli/slurm.py $<TARGET_FILE:pellicle_program>)
    set_tests_properties(cli/slurm PROPERTIES SKIP_RETURN_CODE 77)
    # scenes against the schema for editors; skipped without Debian's python3-jsonschema
    add_test(NAME scene/json_schema COMMAND ${PYTHON3} ${CMAKE_CURRENT_SOURCE_DIR}/scene/schema.py
                                            $<TARGET_FILE:pellicle_program> ${PROJECT_SOURCE_DIR})
    set_tests_properties(scene/json_schema PROPERTIES SKIP_RETURN_CODE 77)
    # Mesa leaks a little where it draws; view/render counts what is ours by itself
    foreach(name render reproduce)
        if(TEST cli/${name})
            set_tests_properties(cli/${name} PROPERTIES ENVIRONMENT "LSAN_OPTIONS=detect_leaks=0")
        endif()
    endforeach()
    # skipped without OpenGL
    if(TEST cli/render)
        set_tests_properties(cli/render PROPERTIES SKIP_REGULAR_EXPRESSION "error: cannot draw")
    endif()
endif()
