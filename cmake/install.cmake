# cmake --install: library, headers, program, scenes, CMake package and pkg-config files.
# The scene and view libraries have exports of their own, so that the core is usable where what they need is not installed.
# Components: dev (libraries, headers), program, and python, which only the Debian packages contain.
include(CMakePackageConfigHelpers)
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME dev)
set(PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/pellicle)

# core
install(TARGETS ${CORE_LIBRARIES} EXPORT pellicleTargets)
install(EXPORT pellicleTargets NAMESPACE pellicle:: DESTINATION ${PACKAGE_DIR})
install(DIRECTORY include/pellicle DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(FILES LICENSE README.md CHANGELOG.md CITATION.cff CONTRIBUTING.md SECURITY.md DESTINATION ${CMAKE_INSTALL_DOCDIR}
        COMPONENT program OPTIONAL)
install(DIRECTORY docs examples DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program OPTIONAL PATTERN __pycache__ EXCLUDE)
install(DIRECTORY scenes DESTINATION ${CMAKE_INSTALL_DATADIR}/pellicle COMPONENT program OPTIONAL FILES_MATCHING PATTERN *.yaml)

# the pages of `pellicle report` and `pellicle live`; made by `make web` and `make wasm`, which this does not wait for
install(FILES ${PROJECT_SOURCE_DIR}/build/web/report.html ${PROJECT_SOURCE_DIR}/build/web/live.html
        ${PROJECT_SOURCE_DIR}/build/web/play.html DESTINATION ${CMAKE_INSTALL_DATADIR}/pellicle COMPONENT program OPTIONAL)

# CMake package
configure_package_config_file(cmake/pellicle-config.cmake.in pellicle-config.cmake INSTALL_DESTINATION ${PACKAGE_DIR})
write_basic_package_version_file(pellicle-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/pellicle-config.cmake ${PROJECT_BINARY_DIR}/pellicle-config-version.cmake
        DESTINATION ${PACKAGE_DIR})

# pkg-config
if(PELLICLE_SINGLE)
    set(PC_CFLAGS -DPEL_SINGLE)
endif()
file(RELATIVE_PATH PC_UP /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
# `pellicle` is the shared library where it was built, else the archive
set(PC_CORE "Requires: pellicle-static = ${PROJECT_VERSION}")
if(PELLICLE_SHARED)
    set(PC_CORE "Libs: -L\${libdir} -lpellicle")
endif()
foreach(package pellicle pellicle-static)
    configure_file(cmake/${package}.pc.in ${package}.pc @ONLY)
    install(FILES ${PROJECT_BINARY_DIR}/${package}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endforeach()

# scenes and program
if(TARGET pellicle_scene)
    set_target_properties(pellicle_scene PROPERTIES EXPORT_NAME scene)
    install(TARGETS pellicle_scene EXPORT pellicleSceneTargets)
    install(EXPORT pellicleSceneTargets NAMESPACE pellicle:: DESTINATION ${PACKAGE_DIR})
    configure_file(cmake/pellicle-scene.pc.in pellicle-scene.pc @ONLY)
    install(FILES ${PROJECT_BINARY_DIR}/pellicle-scene.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endif()
if(TARGET pellicle_view)
    set_target_properties(pellicle_view PROPERTIES EXPORT_NAME view)
    install(TARGETS pellicle_view EXPORT pellicleViewTargets)
    install(EXPORT pellicleViewTargets NAMESPACE pellicle:: DESTINATION ${PACKAGE_DIR})
    configure_file(cmake/pellicle-view.pc.in pellicle-view.pc @ONLY)
    install(FILES ${PROJECT_BINARY_DIR}/pellicle-view.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endif()
if(TARGET pellicle_live)
    set_target_properties(pellicle_live PROPERTIES EXPORT_NAME live)
    install(TARGETS pellicle_live EXPORT pellicleLiveTargets)
    install(EXPORT pellicleLiveTargets NAMESPACE pellicle:: DESTINATION ${PACKAGE_DIR})
    configure_file(cmake/pellicle-live.pc.in pellicle-live.pc @ONLY)
    install(FILES ${PROJECT_BINARY_DIR}/pellicle-live.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endif()
if(TARGET pellicle_program)
    install(TARGETS pellicle_program COMPONENT program)
endif()

# what the program prints about itself: completion for shells, the manual page, the schema for editors
if(TARGET pellicle_program AND NOT CMAKE_CROSSCOMPILING)
    set(PRINTED ${PROJECT_BINARY_DIR}/printed)
    install(CODE "
        file(MAKE_DIRECTORY \"${PRINTED}\")
        foreach(PAIR \"pellicle=completion bash\" \"_pellicle=completion zsh\" \"pellicle.fish=completion fish\"
                     \"pellicle.1=help --man\" \"scene.schema.json=schema\")
            string(REGEX MATCH \"^([^=]*)=(.*)\" MATCHED \"\${PAIR}\")
            separate_arguments(WORDS UNIX_COMMAND \"\${CMAKE_MATCH_2}\")
            execute_process(COMMAND \"$<TARGET_FILE:pellicle_program>\" \${WORDS} OUTPUT_FILE \"${PRINTED}/\${CMAKE_MATCH_1}\"
                            COMMAND_ERROR_IS_FATAL ANY)
        endforeach()" COMPONENT program)
    install(FILES ${PRINTED}/pellicle DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT program)
    install(FILES ${PRINTED}/_pellicle DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions COMPONENT program)
    install(FILES ${PRINTED}/pellicle.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT program)
    install(FILES ${PRINTED}/pellicle.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program)
    install(FILES ${PRINTED}/scene.schema.json DESTINATION ${CMAKE_INSTALL_DATADIR}/pellicle COMPONENT program)
endif()

# the Python package as Debian places it
if(TARGET pellicle_python)
    set(PYTHON_PLACE lib/python3/dist-packages/pellicle)
    install(TARGETS pellicle_python LIBRARY DESTINATION ${PYTHON_PLACE} COMPONENT python EXCLUDE_FROM_ALL)
    install(DIRECTORY python/pellicle/ DESTINATION ${PYTHON_PLACE} COMPONENT python EXCLUDE_FROM_ALL
            FILES_MATCHING PATTERN *.py PATTERN *.pyi PATTERN py.typed PATTERN __pycache__ EXCLUDE)
endif()

# everything that is installed and nothing else, for `make install` from any state of the build
set(INSTALLED ${CORE_LIBRARIES})
foreach(target pellicle_scene pellicle_view pellicle_live pellicle_program)
    if(TARGET ${target})
        list(APPEND INSTALLED ${target})
    endif()
endforeach()
add_custom_target(installed DEPENDS ${INSTALLED})
