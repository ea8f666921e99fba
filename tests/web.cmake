# The pages of reports and of `pellicle live` in a browser, and what npm can check. Reported as skipped where Node.js, Chromium or the libraries
# of web/ are missing (`make web` brings them). A sanitized program is as slow as it is of no use here.
if(TARGET pellicle_program AND NOT PELLICLE_SANITIZE AND NOT PELLICLE_COVERAGE)
    set(PAGES report exports pellicle examples)
    if(TARGET pellicle_live)
        list(APPEND PAGES live trainer immersive play)
    endif()
    foreach(name ${PAGES})
        add_test(NAME web/${name} COMMAND bash ${PROJECT_SOURCE_DIR}/web/test/run ${name} $<TARGET_FILE:pellicle_program>)
        set_tests_properties(web/${name} PROPERTIES SKIP_RETURN_CODE 77 TIMEOUT 300 RUN_SERIAL ON)
    endforeach()
endif()
