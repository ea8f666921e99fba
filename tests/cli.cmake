# The command line: each tests/cli/cases/NAME.txt is the test cli/NAME.
if(TARGET pellicle_program)
    file(GLOB CLI_CASES CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/cli/cases/*.txt)
    foreach(path ${CLI_CASES})
        get_filename_component(name ${path} NAME_WE)
        if(name MATCHES "^render" AND NOT TARGET pellicle_view)
            continue()
        endif()
        add_test(NAME cli/${name} COMMAND ${PYTHON3} ${CMAKE_CURRENT_SOURCE_DIR}/cli/run_case.py
                                          $<TARGET_FILE:pellicle_program> ${path})
    endforeach()
    # skipped without OpenGL; Mesa leaks a little
    if(TEST cli/render)
        set_tests_properties(cli/render PROPERTIES SKIP_REGULAR_EXPRESSION "error: cannot draw"
                                                   ENVIRONMENT "LSAN_OPTIONS=detect_leaks=0")
    endif()
endif()
